#include "granular/mesh/mesh_header.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>
#include <vector>

#include "granular/core/errors.h"

namespace granular {
namespace {

using Json = nlohmann::json;

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw InputError("mesh " + path + ": " + reason);
}

MeshFormat formatOf(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static const std::map<std::string, MeshFormat> known = {{".obj", MeshFormat::obj},   {".stl", MeshFormat::stl},
                                                          {".ply", MeshFormat::ply},   {".off", MeshFormat::off},
                                                          {".gltf", MeshFormat::gltf}, {".glb", MeshFormat::glb}};
  const auto found = known.find(extension);
  if (found == known.end()) {
    refuse(path, "unsupported format '" + extension + "'; allowed: .obj .stl .ply .off .gltf .glb");
  }
  return found->second;
}

std::string readBytes(const std::string& path, std::int64_t bytes) {
  std::ifstream in(path, std::ios::binary);
  if (!in) refuse(path, "can't be opened for reading");
  std::string content(static_cast<std::size_t>(bytes), '\0');
  in.read(content.data(), bytes);
  content.resize(static_cast<std::size_t>(in.gcount()));
  return content;
}

// Splits off the next word; empty at the end of the text.
std::string_view nextWord(std::string_view& text) {
  const auto isSpace = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  while (!text.empty() && isSpace(text.front())) text.remove_prefix(1);
  std::size_t length = 0;
  while (length < text.size() && !isSpace(text[length])) ++length;
  const std::string_view word = text.substr(0, length);
  text.remove_prefix(length);
  return word;
}

std::string_view nextLine(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

bool parseCount(std::string_view word, std::int64_t& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

// True if the word is a number that single precision holds.
bool isFiniteNumber(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range) return std::abs(value) < 1;  // too small is 0, too large is infinite
  return error == std::errc() && std::isfinite(static_cast<float>(value));
}

void requireCount(const std::string& path, const std::string& what, std::int64_t count, std::int64_t limit,
                  const std::string& why) {
  if (count < 0 || count > limit) {
    refuse(path, "announces " + std::to_string(count) + " " + what + "; " + why + " at most " + std::to_string(limit));
  }
}

// The corners of an OBJ face: "7", "7/2", "7//3", "-1"; marks the vertices it uses.
void readObjFace(const std::string& path, std::int64_t lineNumber, std::string_view rest, std::vector<bool>& used,
                 std::int64_t listed) {
  for (std::string_view word = nextWord(rest); !word.empty() && word.front() != '#'; word = nextWord(rest)) {
    std::int64_t index = 0;
    const bool isNumber = parseCount(word.substr(0, word.find('/')), index);
    if (!isNumber)
      refuse(path, "line " + std::to_string(lineNumber) + ": '" + std::string(word) + "' is no vertex index");
    const std::int64_t vertex = index < 0 ? listed + index : index - 1;
    if (vertex < 0 || vertex >= maxMeshVertices) {
      refuse(path,
             "line " + std::to_string(lineNumber) + ": vertex index " + std::to_string(index) + " is out of range");
    }
    if (static_cast<std::size_t>(vertex) >= used.size()) used.resize(static_cast<std::size_t>(vertex) + 1, false);
    used[static_cast<std::size_t>(vertex)] = true;
  }
}

// OBJ has no header: the text itself is counted.
void checkObj(const std::string& path, MeshHeader& header) {
  const std::string content = readBytes(path, header.bytes);
  std::string_view text = content;
  FileVertices file;
  std::vector<bool> used;
  std::vector<std::size_t> nonFinite;
  for (std::int64_t lineNumber = 1; !text.empty(); ++lineNumber) {
    std::string_view line = nextLine(text);
    const std::string_view keyword = nextWord(line);
    if (keyword == "v") {
      bool finite = true;
      for (int k = 0; k < 3; ++k) finite = isFiniteNumber(nextWord(line)) && finite;
      if (!finite) nonFinite.push_back(static_cast<std::size_t>(file.listed));
      ++file.listed;
    } else if (keyword == "f") {
      readObjFace(path, lineNumber, line, used, file.listed);
      ++header.faces;
    }
  }
  if (file.listed == 0) refuse(path, "is not a mesh: no line 'v x y z'");
  if (header.faces == 0) refuse(path, "is empty: " + std::to_string(file.listed) + " vertices but no face");
  if (static_cast<std::int64_t>(used.size()) > file.listed) {
    refuse(path, "a face uses vertex " + std::to_string(used.size()) + " of " + std::to_string(file.listed));
  }
  used.resize(static_cast<std::size_t>(file.listed), false);
  file.unreferenced = file.listed - std::count(used.begin(), used.end(), true);
  file.nonFinite = static_cast<std::int64_t>(nonFinite.size());
  file.usable = file.listed - file.unreferenced -
                std::count_if(nonFinite.begin(), nonFinite.end(), [&](std::size_t v) { return used[v]; });
  header.vertices = file.listed;
  header.file = file;
}

// Binary STL: 80 bytes, a count, 50 bytes per triangle. Text STL begins with "solid" and is counted by its facets.
void checkStl(const std::string& path, MeshHeader& header) {
  std::string head = readBytes(path, std::min<std::int64_t>(header.bytes, 84));
  std::uint32_t count = 0;
  if (head.size() == 84) std::memcpy(&count, head.data() + 80, 4);
  if (head.size() == 84 && header.bytes == 84 + 50 * std::int64_t{count}) {
    header.faces = count;
  } else if (head.rfind("solid", 0) == 0) {
    const std::string content = readBytes(path, header.bytes);
    for (std::size_t at = content.find("endfacet"); at != std::string::npos; at = content.find("endfacet", at + 8))
      ++header.faces;
    if (header.faces == 0 && content.find("endsolid") == std::string::npos) {
      refuse(path, "is not a mesh: begins like a text STL but holds no facet");
    }
  } else if (head.size() == 84) {
    refuse(path, "is truncated or not an STL: the header announces " + std::to_string(count) +
                     " triangles, which take " + std::to_string(84 + 50 * std::int64_t{count}) +
                     " bytes; the file has " + std::to_string(header.bytes));
  } else {
    refuse(path, "is not a mesh: neither a text STL nor long enough for a binary one");
  }
  if (header.faces == 0) refuse(path, "is empty: no triangle");
  header.vertices = 3 * header.faces;
}

// One element of a PLY header: its count and the fewest bytes one of its rows takes.
struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::int64_t rowBytes = 0;
};

std::int64_t plyTypeBytes(std::string_view type) {
  static const std::map<std::string_view, std::int64_t> sizes = {
      {"char", 1},   {"int8", 1},    {"uchar", 1},  {"uint8", 1},  {"short", 2}, {"int16", 2},
      {"ushort", 2}, {"uint16", 2},  {"int", 4},    {"int32", 4},  {"uint", 4},  {"uint32", 4},
      {"float", 4},  {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = sizes.find(type);
  return found == sizes.end() ? 0 : found->second;
}

// The loader fills up missing rows of a text file by itself: so they are counted.
void checkPlyRows(const std::string& path, std::size_t headerBytes, const MeshHeader& header,
                  const std::vector<PlyElement>& elements) {
  const std::string content = readBytes(path, header.bytes);
  std::string_view text = content;
  text.remove_prefix(headerBytes);
  std::int64_t rows = 0;
  while (!text.empty()) {
    std::string_view line = nextLine(text);
    if (!nextWord(line).empty()) ++rows;
  }
  for (const PlyElement& element : elements) {
    requireCount(path, "of element '" + element.name + "'", element.count, rows, "the file's rows allow");
    rows -= element.count;
  }
}

void checkPly(const std::string& path, MeshHeader& header) {
  const std::string content = readBytes(path, std::min<std::int64_t>(header.bytes, 1 << 16));
  std::string_view text = content;
  if (nextWord(text) != "ply") refuse(path, "is not a mesh: a PLY file begins with 'ply'");
  bool ascii = false, ended = false;
  std::vector<PlyElement> elements;
  while (!text.empty() && !ended) {
    std::string_view line = nextLine(text);
    const std::string_view keyword = nextWord(line);
    if (keyword == "format") {
      ascii = nextWord(line) == "ascii";
    } else if (keyword == "element") {
      PlyElement element;
      element.name = std::string(nextWord(line));
      if (!parseCount(nextWord(line), element.count))
        refuse(path, "no count in the header of element '" + element.name + "'");
      elements.push_back(element);
    } else if (keyword == "property" && !elements.empty()) {
      // A number takes at least a digit and a blank; a list at least its length.
      const std::string_view type = nextWord(line);
      const std::int64_t bytes = plyTypeBytes(type == "list" ? nextWord(line) : type);
      if (bytes == 0) refuse(path, "unknown property type in the header of element '" + elements.back().name + "'");
      elements.back().rowBytes += ascii ? 2 : bytes;
    }
    ended = keyword == "end_header";
  }
  if (!ended) refuse(path, "is not a mesh: the PLY header has no end");
  if (ascii) checkPlyRows(path, static_cast<std::size_t>(text.data() - content.data()), header, elements);
  // What is left after the header must hold every row.
  std::int64_t left = header.bytes - static_cast<std::int64_t>(content.size() - text.size()) + 1;
  for (const PlyElement& element : elements) {
    const std::int64_t rowBytes = std::max<std::int64_t>(element.rowBytes, 1);
    requireCount(path, "of element '" + element.name + "'", element.count, left / rowBytes, "the file's size allows");
    left -= element.count * rowBytes;
    if (element.name == "vertex") header.vertices = element.count;
    if (element.name == "face") header.faces = element.count;
  }
}

// The next line that is neither blank nor a comment.
std::string_view nextRow(std::string_view& text) {
  while (!text.empty()) {
    const std::string_view line = nextLine(text);
    std::string_view rest = line;
    const std::string_view word = nextWord(rest);
    if (!word.empty() && word.front() != '#') return line;
  }
  return {};
}

// The loader takes an index out of range for the last vertex: so the rows are read here too.
void checkOffFaces(const std::string& path, std::string_view text, const MeshHeader& header) {
  nextLine(text);
  for (std::int64_t v = 0; v < header.vertices; ++v) nextRow(text);
  for (std::int64_t f = 0; f < header.faces; ++f) {
    std::string_view row = nextRow(text);
    std::int64_t corners = 0;
    if (!parseCount(nextWord(row), corners) || corners < 1 || corners > header.bytes) {
      refuse(path, "face " + std::to_string(f) + " of " + std::to_string(header.faces) + " can't be read");
    }
    for (std::int64_t k = 0; k < corners; ++k) {
      std::int64_t index = -1;
      const std::string_view word = nextWord(row);
      if (parseCount(word, index) && index >= 0 && index < header.vertices) continue;
      refuse(path, "face " + std::to_string(f) + " uses vertex '" + std::string(word.substr(0, 20)) + "' of " +
                       std::to_string(header.vertices));
    }
  }
}

void checkOff(const std::string& path, MeshHeader& header) {
  const std::string content = readBytes(path, header.bytes);
  std::string_view text = content;
  const std::string_view magic = nextWord(text);
  if (magic.size() < 3 || magic.substr(magic.size() - 3) != "OFF")
    refuse(path, "is not a mesh: an OFF file begins with 'OFF'");
  // Comments may stand between the magic word and the counts.
  std::array<std::int64_t, 2> counts{};
  for (std::int64_t& count : counts) {
    std::string_view word = nextWord(text);
    while (!word.empty() && word.front() == '#') {
      nextLine(text);
      word = nextWord(text);
    }
    if (!parseCount(word, count))
      refuse(path, "is not a mesh: '" + std::string(word.substr(0, 20)) + "' stands where OFF has its counts");
  }
  // "0 0 0\n" and "3 0 1 2\n" are the shortest rows.
  requireCount(path, "vertices", counts[0], header.bytes / 6, "the file's size allows");
  requireCount(path, "faces", counts[1], header.bytes / 8, "the file's size allows");
  header.vertices = counts[0];
  header.faces = counts[1];
  checkOffFaces(path, text, header);
}

// An unsigned number of a glTF object; absent reads as the default.
std::int64_t numberOf(const std::string& path, const Json& object, const char* key, std::int64_t otherwise) {
  if (!object.is_object()) refuse(path, "is not a mesh: glTF entry is no object");
  const auto found = object.find(key);
  if (found == object.end()) return otherwise;
  if (!found->is_number_unsigned()) refuse(path, std::string("glTF '") + key + "' is no count");
  // The cap keeps products of counts and sizes far from overflow.
  return std::min(found->get<std::uint64_t>(), std::uint64_t{1} << 40) & INT64_MAX;
}

const Json& listOf(const std::string& path, const Json& document, const char* key) {
  static const Json none = Json::array();
  const auto found = document.find(key);
  if (found == document.end()) return none;
  if (!found->is_array()) refuse(path, std::string("glTF '") + key + "' is no list");
  return *found;
}

// Bytes that stand behind a glTF buffer: the binary chunk, the text of a data address, or a file beside it.
std::int64_t bufferBytes(const std::string& path, const Json& buffer, std::int64_t chunkBytes) {
  const auto uri = buffer.find("uri");
  if (uri == buffer.end()) return chunkBytes;
  if (!uri->is_string()) refuse(path, "glTF buffer address is no text");
  const std::string address = uri->get<std::string>();
  if (address.rfind("data:", 0) == 0) return static_cast<std::int64_t>(address.size());
  // No file elsewhere, whoever wrote the mesh: not up and out of the folder, not by an absolute path, not by a link.
  std::error_code error;
  const auto folder = std::filesystem::weakly_canonical(path).parent_path();
  const auto file = std::filesystem::weakly_canonical(folder / address, error);
  if (error || !isBelow(file, folder)) refuse(path, "glTF buffer file '" + address + "' is outside the mesh's folder");
  if (!std::filesystem::is_regular_file(file, error)) refuse(path, "glTF buffer file '" + address + "' is missing");
  const auto bytes = std::filesystem::file_size(file, error);
  if (error) refuse(path, "glTF buffer file '" + address + "' is missing");
  return static_cast<std::int64_t>(bytes);
}

void checkGltfDocument(const std::string& path, const std::string& text, std::int64_t chunkBytes, MeshHeader& header) {
  const Json document = Json::parse(text, nullptr, false);
  if (document.is_discarded() || !document.is_object() || !document.contains("asset"))
    refuse(path, "is not a mesh: no glTF document");
  std::vector<std::int64_t> buffers, views;
  for (const Json& buffer : listOf(path, document, "buffers")) {
    buffers.push_back(numberOf(path, buffer, "byteLength", 0));
    requireCount(path, "bytes in a glTF buffer", buffers.back(), bufferBytes(path, buffer, chunkBytes), "it holds");
  }
  for (const Json& view : listOf(path, document, "bufferViews")) {
    const std::int64_t buffer = numberOf(path, view, "buffer", 0);
    if (buffer >= static_cast<std::int64_t>(buffers.size()))
      refuse(path, "glTF buffer " + std::to_string(buffer) + " is missing");
    views.push_back(numberOf(path, view, "byteLength", 0));
    requireCount(path, "bytes in a glTF buffer view", numberOf(path, view, "byteOffset", 0) + views.back(),
                 buffers[static_cast<std::size_t>(buffer)], "its buffer holds");
  }
  // An accessor's smallest element is one byte; without a view it is all zeros and bounded by the mesh limits alone.
  for (const Json& accessor : listOf(path, document, "accessors")) {
    const std::int64_t count = numberOf(path, accessor, "count", 0);
    const std::int64_t view = numberOf(path, accessor, "bufferView", -1);
    if (view >= static_cast<std::int64_t>(views.size()))
      refuse(path, "glTF buffer view " + std::to_string(view) + " is missing");
    requireCount(path, "elements in a glTF accessor", count,
                 view < 0 ? maxMeshVertices : views[static_cast<std::size_t>(view)], "its data allow");
  }
  if (listOf(path, document, "meshes").empty()) refuse(path, "is empty: the glTF document holds no mesh");
  header.vertices = header.faces = 0;
}

void checkGltf(const std::string& path, MeshHeader& header) {
  const std::string content = readBytes(path, header.bytes);
  if (header.format == MeshFormat::gltf) return checkGltfDocument(path, content, 0, header);
  // GLB: magic, version, length; then chunks of length, type, data: JSON first, binary second.
  std::array<std::uint32_t, 5> words{};
  if (content.size() < sizeof words || content.compare(0, 4, "glTF") != 0)
    refuse(path, "is not a mesh: a GLB file begins with 'glTF'");
  std::memcpy(words.data(), content.data(), sizeof words);
  const std::int64_t length = words[2], jsonBytes = words[3];
  if (words[1] != 2) refuse(path, "GLB version " + std::to_string(words[1]) + "; only version 2 is supported");
  if (length > header.bytes)
    refuse(path,
           "is truncated: announces " + std::to_string(length) + " bytes and has " + std::to_string(header.bytes));
  if (words[4] != 0x4E4F534A || 20 + jsonBytes > header.bytes)
    refuse(path, "is not a mesh: its first GLB chunk is no JSON");
  std::uint32_t chunkBytes = 0;
  if (28 + jsonBytes <= header.bytes) std::memcpy(&chunkBytes, content.data() + 20 + jsonBytes, 4);
  if (28 + jsonBytes + chunkBytes > header.bytes && chunkBytes > 0) {
    refuse(path, "is truncated: its binary chunk announces " + std::to_string(chunkBytes) + " bytes");
  }
  checkGltfDocument(path, content.substr(20, static_cast<std::size_t>(jsonBytes)), chunkBytes, header);
}

}  // namespace

std::string formatName(MeshFormat format) {
  static const std::array<const char*, 6> names = {"OBJ", "STL", "PLY", "OFF", "glTF", "GLB"};
  return names[static_cast<std::size_t>(format)];
}

bool isBelow(const std::filesystem::path& file, const std::filesystem::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

MeshHeader checkMeshHeader(const std::string& path) {
  // The file itself.
  std::error_code error;
  if (!std::filesystem::exists(path, error)) refuse(path, "no such file");
  if (!std::filesystem::is_regular_file(path, error)) refuse(path, "is not a file");
  MeshHeader header;
  header.format = formatOf(path);
  header.bytes = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
  if (error) refuse(path, "can't be read: " + error.message());
  if (header.bytes == 0) refuse(path, "is empty: 0 bytes");
  if (header.bytes > maxMeshBytes) {
    refuse(path, "is too big: " + std::to_string(header.bytes) + " bytes; at most " + std::to_string(maxMeshBytes));
  }
  // What its format says it holds.
  switch (header.format) {
    case MeshFormat::obj:
      checkObj(path, header);
      break;
    case MeshFormat::stl:
      checkStl(path, header);
      break;
    case MeshFormat::ply:
      checkPly(path, header);
      break;
    case MeshFormat::off:
      checkOff(path, header);
      break;
    default:
      checkGltf(path, header);
  }
  const bool counted = header.format != MeshFormat::gltf && header.format != MeshFormat::glb;
  if (counted && header.vertices == 0) refuse(path, "is empty: no vertex");
  if (counted && header.faces == 0)
    refuse(path, "is empty: " + std::to_string(header.vertices) + " vertices but no face");
  requireCount(path, "vertices", header.vertices, maxMeshVertices, "accepted are");
  requireCount(path, "faces", header.faces, maxMeshFaces, "accepted are");
  return header;
}

}  // namespace granular
