// Bytes of a fuzzer taken apart: numbers from the front, zeros when they are used up.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace granular::fuzz {

class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : bytes(reinterpret_cast<const char*>(data), size) {}

  template <class T>
  T take() {
    T value{};
    const std::size_t count = std::min(sizeof(T), bytes.size());
    if (count > 0) std::memcpy(&value, bytes.data(), count);
    bytes.remove_prefix(count);
    return value;
  }
  std::string_view rest() const { return bytes; }
  bool empty() const { return bytes.empty(); }

 private:
  std::string_view bytes;
};

/// A folder of this process's own for files that readers want to open.
inline const std::filesystem::path& scratch() {
  static const std::filesystem::path folder = [] {
    const auto path = std::filesystem::temp_directory_path() / ("granular_fuzz_" + std::to_string(::getpid()));
    std::filesystem::create_directories(path);
    std::atexit([] {
      std::error_code ignored;
      std::filesystem::remove_all(scratch(), ignored);
    });
    return path;
  }();
  return folder;
}

inline void writeFile(const std::filesystem::path& path, std::string_view content) {
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(content.data(), static_cast<std::streamsize>(content.size()));
}

}  // namespace granular::fuzz
