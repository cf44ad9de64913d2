#include "granular/io/output_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

#include "granular/core/errors.h"

namespace granular {

namespace fs = std::filesystem;

void prepareOutputFolder(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    throw InputError(fmt::format("{}: the output folder can't be used: a file has that name", folder.string()));
  fs::create_directories(folder, error);
  if (error) throw InputError(fmt::format("{}: the output folder can't be made: {}", folder.string(), error.message()));
  // Rights, read-only disks and full ones all show when something is written.
  OutputFile probe(folder / "writable");
  probe.write("x");
  probe.finish();
  fs::remove(folder / "writable", error);
}

OutputFile::OutputFile(fs::path target) : path(std::move(target)) {
  partial = path.parent_path() / fmt::format(".{}.partial", path.filename().string());
  errno = 0;
  stream.open(partial, std::ios::binary | std::ios::trunc);
  if (!stream) throw InputError(fmt::format("{}: can't be written: {}", path.string(), std::strerror(errno)));
}

OutputFile::~OutputFile() {
  if (finished) return;
  stream.close();
  std::error_code ignored;
  fs::remove(partial, ignored);
}

void OutputFile::write(std::string_view text) { stream.write(text.data(), static_cast<std::streamsize>(text.size())); }

void OutputFile::write(std::span<const std::byte> bytes) {
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

void OutputFile::finish() {
  stream.close();
  if (!stream) throw InputError(fmt::format("{}: can't be written whole (disk full?)", path.string()));
  std::error_code error;
  fs::rename(partial, path, error);
  if (error) throw InputError(fmt::format("{}: can't be written: {}", path.string(), error.message()));
  finished = true;
}

}  // namespace granular
