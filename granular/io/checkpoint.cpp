#include "granular/io/checkpoint.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <span>

#include "granular/core/child_process.h"
#include "granular/io/digest.h"

namespace granular {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t blockSize = 512;
constexpr std::string_view magic = "granular checkpoint ";
constexpr std::string_view currentName = "checkpoint.h5", previousName = "checkpoint_previous.h5";

/// An HDF5 identifier that closes itself; throws if the call that made it failed.
class Handle {
 public:
  Handle(hid_t opened, herr_t (*closer)(hid_t), const char* what) : id(opened), close(closer) {
    if (id < 0) throw std::runtime_error(std::string("HDF5 failed to ") + what);
  }
  ~Handle() { close(id); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id; }

 private:
  hid_t id;
  herr_t (*close)(hid_t);
};

void require5(herr_t status, const char* what) {
  if (status < 0) throw std::runtime_error(std::string("HDF5 failed to ") + what);
}

/// Keeps HDF5 from printing its errors while it lives; ours are thrown.
class QuietErrors {
 public:
  QuietErrors() {
    H5Eget_auto2(H5E_DEFAULT, &function, &data);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~QuietErrors() { H5Eset_auto2(H5E_DEFAULT, function, data); }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  H5E_auto2_t function = nullptr;
  void* data = nullptr;
};

hid_t memoryType(ElementType type) {
  switch (type) {
    case ElementType::float64:
      return H5T_NATIVE_DOUBLE;
    case ElementType::int32:
      return H5T_NATIVE_INT32;
    case ElementType::int64:
      return H5T_NATIVE_INT64;
    case ElementType::uint64:
      return H5T_NATIVE_UINT64;
    case ElementType::uint8:
    case ElementType::text:
      return H5T_NATIVE_UINT8;
  }
  return H5T_NATIVE_UINT8;
}

/// A fixed-length string type of at least one byte.
Handle makeTextType(std::size_t size) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, std::max<std::size_t>(size, 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  return {type, H5Tclose, "make a text type"};
}

// ---------------------------------------------------------------------------------------------------- writing

void writeAttribute(hid_t object, const char* name, std::string_view text) {
  const Handle type = makeTextType(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "make a space");
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         "make an attribute");
  const std::string padded = text.empty() ? std::string(1, '\0') : std::string(text);
  require5(H5Awrite(attribute, type, padded.data()), "write an attribute");
}

void writeDataSet(hid_t file, const std::string& path, const DataSet& set) {
  // Groups on the way are made; no times are kept, so that equal states make equal files.
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "make a property list");
  H5Pset_create_intermediate_group(links, 1);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make a property list");
  H5Pset_obj_track_times(properties, false);

  const bool isText = set.type == ElementType::text;
  const Handle type =
      isText ? makeTextType(set.bytes.size()) : Handle(H5Tcopy(memoryType(set.type)), H5Tclose, "copy a type");
  const hsize_t shape[] = {set.rows, set.width};
  const bool scalar = isText || (set.single && set.width == 1);
  const hsize_t* dimensions = set.single ? shape + 1 : shape;
  const int rank = set.single || set.width == 1 ? 1 : 2;
  const Handle space(scalar ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, dimensions, nullptr), H5Sclose,
                     "make a space");
  const Handle dataSet(H5Dcreate2(file, path.c_str(), type, space, links, properties, H5P_DEFAULT), H5Dclose,
                       "make a data set");
  const std::byte nothing{0};
  if (scalar || !set.bytes.empty())
    require5(H5Dwrite(dataSet, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, set.bytes.empty() ? &nothing : set.bytes.data()),
             "write a data set");
  if (!set.unit.empty()) writeAttribute(dataSet, "unit", set.unit);
  if (!set.description.empty()) writeAttribute(dataSet, "description", set.description);
  // What the shape of the space doesn't tell.
  const std::string layout =
      fmt::format("{} {} {} {}", static_cast<int>(set.type), set.rows, set.width, set.single ? 1 : 0);
  writeAttribute(dataSet, "layout", layout);
}

/// What stands behind the first block, in memory. HDF5 finds its own beginning there, as in any file with a user block,
/// and takes all addresses from it. It writes no file of ours: one that fails in its hands, on a
/// full disk, takes the process down when HDF5 closes it again at exit.
std::vector<char> makeHdf5(const Archive& archive) {
  const QuietErrors quiet;
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "make a property list");
  H5Pset_obj_track_times(creation, false);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "make a property list");
  constexpr std::size_t growth = 16 << 20;
  require5(H5Pset_fapl_core(access, growth, false), "keep a file in memory");
  const Handle file(H5Fcreate("checkpoint", H5F_ACC_TRUNC, creation, access), H5Fclose, "make the file");
  for (const auto& [name, set] : archive.content()) writeDataSet(file, name, set);
  require5(H5Fflush(file, H5F_SCOPE_GLOBAL), "flush the file");
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size <= 0) throw std::runtime_error("HDF5 failed to hand out the file");
  std::vector<char> image(static_cast<std::size_t>(size));
  if (H5Fget_file_image(file, image.data(), image.size()) != size)
    throw std::runtime_error("HDF5 failed to hand out the file");
  return image;
}

/// Digest and length of what lies behind the first block.
std::pair<std::string, std::uint64_t> digestBehindBlock(std::istream& file) {
  Digest digest;
  std::uint64_t length = 0;
  std::vector<char> buffer(1 << 20);
  file.seekg(blockSize);
  while (file) {
    file.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    const auto count = static_cast<std::size_t>(file.gcount());
    digest.add(std::as_bytes(std::span(buffer.data(), count)));
    length += count;
  }
  return {digest.finishHex(), length};
}

// ---------------------------------------------------------------------------------------------------- reading

/// The block at the start of a checkpoint.
struct Header {
  int version = 0;
  std::uint64_t length = 0;
  std::string digest;
};

std::string formatHeader(const Header& header) {
  std::string text = fmt::format("{}{}\nlength {}\nsha256 {}\nHDF5 from byte {} on.\n", magic, header.version,
                                 header.length, header.digest, blockSize);
  text.resize(blockSize, ' ');
  text.back() = '\n';
  return text;
}

void flushToDisk(const fs::path& path, int flags) {
  const int descriptor = open(path.c_str(), flags);
  const bool done = descriptor >= 0 && fsync(descriptor) == 0;
  if (descriptor >= 0) close(descriptor);
  if (!done) throw InputError(fmt::format("{}: can't be flushed to the disk: {}", path.string(), strerror(errno)));
}

/// The whole file, down to the disk; throws with the system's reason.
void writeWhole(const fs::path& path, const Archive& archive) {
  const std::vector<char> image = makeHdf5(archive);
  Digest digest;
  digest.add(std::as_bytes(std::span(image)));
  const std::string block = formatHeader({checkpointVersion, image.size(), digest.finishHex()});

  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << block;
  file.write(image.data(), static_cast<std::streamsize>(image.size()));
  file.close();
  if (!file) throw std::runtime_error(errno != 0 ? strerror(errno) : "not all of it was taken");
  flushToDisk(path, O_RDONLY);
}

/// Reads and checks everything but HDF5's own content; returns the reason to refuse the file, or nothing.
std::string findDamage(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return "it can't be opened";
  std::string block(blockSize, '\0');
  file.read(block.data(), blockSize);
  if (!block.starts_with(magic)) return "it is not a checkpoint of this program";
  Header header;
  char digest[65] = "";
  if (file.gcount() != blockSize) return "it is cut short";
  if (std::sscanf(block.c_str() + magic.size(), "%d\nlength %lu\nsha256 %64s", &header.version, &header.length,
                  digest) != 3)
    return "its first block is damaged";
  if (header.version != checkpointVersion)
    return fmt::format("it has format version {}, this program reads {}", header.version, checkpointVersion);
  const auto [found, length] = digestBehindBlock(file);
  if (length != header.length) return fmt::format("it is cut short: {} bytes of {}", length, header.length);
  if (found != digest) return "it is damaged: its SHA-256 does not match";
  header.digest = digest;
  if (formatHeader(header) != block) return "its first block is damaged";
  return "";
}

std::string readAttribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return "";
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, "open an attribute");
  const Handle type(H5Aget_type(attribute), H5Tclose, "read a type");
  const std::size_t size = H5Tget_size(type);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 || size > 100000)
    throw std::runtime_error("an attribute is no plain text");
  std::string text(size, '\0');
  require5(H5Aread(attribute, type, text.data()), "read an attribute");
  return text == std::string(1, '\0') ? "" : text;
}

DataSet readDataSet(hid_t file, const char* path) {
  const Handle dataSet(H5Dopen2(file, path, H5P_DEFAULT), H5Dclose, "open a data set");
  DataSet set;
  set.unit = readAttribute(dataSet, "unit");
  set.description = readAttribute(dataSet, "description");
  int type = -1, single = 0;
  if (std::sscanf(readAttribute(dataSet, "layout").c_str(), "%d %lu %lu %d", &type, &set.rows, &set.width, &single) !=
          4 ||
      type < 0 || type > static_cast<int>(ElementType::text))
    throw std::runtime_error("a data set has no layout");
  set.type = static_cast<ElementType>(type);
  set.single = single != 0;

  // The layout must describe what is there, before anything is allocated by it.
  const Handle space(H5Dget_space(dataSet), H5Sclose, "read a space");
  const Handle stored(H5Dget_type(dataSet), H5Tclose, "read a type");
  const bool isText = set.type == ElementType::text;
  const auto points = static_cast<std::uint64_t>(H5Sget_simple_extent_npoints(space));
  const std::uint64_t numbers = isText ? H5Tget_size(stored) : points;
  const bool emptyText = isText && set.rows == 0 && numbers == 1;
  const bool sameClass = isText ? H5Tget_class(stored) == H5T_STRING && H5Tis_variable_str(stored) == 0 && points == 1
                                : H5Tequal(stored, memoryType(set.type)) > 0;
  if (!sameClass || set.width == 0 || set.width > 1000 ||
      (!emptyText && (numbers % set.width != 0 || numbers / set.width != set.rows)))
    throw std::runtime_error("a data set's layout contradicts its content");
  set.bytes.resize(numbers * elementSize(set.type));
  if (!set.bytes.empty())
    require5(H5Dread(dataSet, stored, H5S_ALL, H5S_ALL, H5P_DEFAULT, set.bytes.data()), "read a data set");
  if (emptyText) set.bytes.clear();
  return set;
}

std::map<std::string, DataSet> readHdf5(const fs::path& path) {
  const QuietErrors quiet;
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open the file");
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5O_info_t* info, void* data) -> herr_t {
    if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(data)->emplace_back(name);
    return 0;
  };
  require5(H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, collect, &names), "list the data sets");
  std::map<std::string, DataSet> content;
  for (const std::string& name : names) content.emplace(name, readDataSet(file, name.c_str()));
  return content;
}

/// What a child that reads sends ahead of every data set: the lengths of what follows. name 0: there are no more; -1: a
/// failure, with its reason as the unit.
struct Announcement {
  std::int64_t name = 0, unit = 0, description = 0, bytes = 0;
  std::uint64_t rows = 0, width = 0;
  std::int32_t type = 0, single = 0;
};

void sendText(int pipe, const std::string& text) { writeToParent(pipe, text.data(), text.size()); }

void readAndSend(const fs::path& path, int pipe) {
  Announcement next;
  try {
    for (const auto& [name, set] : readHdf5(path)) {
      next = {std::ssize(name),
              std::ssize(set.unit),
              std::ssize(set.description),
              std::ssize(set.bytes),
              set.rows,
              set.width,
              static_cast<int>(set.type),
              set.single};
      writeToParent(pipe, &next, sizeof next);
      for (const std::string& text : {name, set.unit, set.description}) sendText(pipe, text);
      writeToParent(pipe, set.bytes.data(), set.bytes.size());
    }
    next = {};
    writeToParent(pipe, &next, sizeof next);
  } catch (const std::exception& error) {
    const std::string reason = error.what();
    next = {};
    next.name = -1;
    next.unit = std::ssize(reason);
    writeToParent(pipe, &next, sizeof next);
    sendText(pipe, reason);
  }
}

/// The content of a file as HDF5 reads it in a process of its own: HDF5 crashes on files made to break it, and the
/// digest is no signature. Throws std::runtime_error with the reason.
std::map<std::string, DataSet> readInChild(const fs::path& path) {
  const auto fileBytes = static_cast<std::int64_t>(fs::file_size(path));
  ChildProcess child("HDF5", {(std::int64_t{1} << 30) + 4 * fileBytes, 60 + 1e-6 * static_cast<double>(fileBytes)},
                     [&](int pipe) { readAndSend(path, pipe); });
  const auto fail = [&] { throw std::runtime_error(child.finish()); };
  const auto readText = [&](std::int64_t length) {
    if (length < 0 || length > 200000) fail();
    std::string text(static_cast<std::size_t>(length), '\0');
    if (!child.read(text.data(), text.size())) fail();
    return text;
  };
  std::map<std::string, DataSet> content;
  for (;;) {
    Announcement next;
    if (!child.read(&next, sizeof next)) fail();
    if (next.name < 0) throw std::runtime_error(readText(next.unit));
    if (next.name == 0) return content;
    const std::string name = readText(next.name);
    DataSet& set = content[name];
    set.unit = readText(next.unit);
    set.description = readText(next.description);
    set.type = static_cast<ElementType>(next.type);
    set.rows = next.rows;
    set.width = next.width;
    set.single = next.single != 0;
    // Content is not packed: no set is longer than the file.
    const bool known = next.type >= 0 && next.type <= static_cast<std::int32_t>(ElementType::text);
    if (!known || next.bytes < 0 || next.bytes > fileBytes || next.width == 0 || next.width > 1000 ||
        static_cast<std::uint64_t>(next.bytes) / next.width / elementSize(set.type) != next.rows)
      fail();
    set.bytes.resize(static_cast<std::size_t>(next.bytes));
    if (!child.read(set.bytes.data(), set.bytes.size())) fail();
  }
}

}  // namespace

void saveCheckpoint(const fs::path& folder, const Archive& archive) {
  const fs::path current = folder / currentName, previous = folder / previousName,
                 partial = folder / ".checkpoint.h5.partial";
  std::error_code error;
  if (!fs::is_directory(folder, error) || access(folder.c_str(), W_OK) != 0)
    throw InputError(
        fmt::format("{}: the checkpoint can't be written: no folder that may be written", folder.string()));

  // On the disk before it takes the place of the last one.
  try {
    writeWhole(partial, archive);
  } catch (const std::exception& reason) {
    fs::remove(partial, error);
    throw InputError(fmt::format("{}: the checkpoint can't be written: {}; {}", current.string(), reason.what(),
                                 fs::exists(current, error) ? "the one before stands" : "there is none before"));
  }
  // There is a checkpoint under the first name at any moment, unless the file system has no second names.
  if (fs::exists(current)) {
    fs::remove(previous, error);
    fs::create_hard_link(current, previous, error);
    if (error) fs::rename(current, previous);
  }
  fs::rename(partial, current);
  flushToDisk(folder, O_RDONLY | O_DIRECTORY);
}

fs::path checkpointFolder(const fs::path& fileOrFolder) {
  if (fs::is_directory(fileOrFolder)) return fileOrFolder;
  return fileOrFolder.has_parent_path() ? fileOrFolder.parent_path() : ".";
}

Archive loadCheckpoint(const fs::path& fileOrFolder) {
  fs::path path = fileOrFolder;
  if (fs::is_directory(path)) path /= currentName;
  const fs::path previous = path.parent_path() / previousName;
  const bool otherExists = path.filename() != previousName && fs::exists(previous);
  const std::string hint = otherExists ? fmt::format("; the one before it is {}", previous.string()) : "";
  if (!fs::exists(path)) throw InputError(fmt::format("{}: there is no such checkpoint{}", path.string(), hint));
  if (const std::string damage = findDamage(path); !damage.empty())
    throw InputError(fmt::format("{}: the checkpoint can't be used: {}{}", path.string(), damage, hint));
  try {
    return Archive(readInChild(path), path.string());
  } catch (const std::runtime_error& error) {
    throw InputError(fmt::format("{}: the checkpoint can't be used: {}{}", path.string(), error.what(), hint));
  }
}

}  // namespace granular
