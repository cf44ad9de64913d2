// Files of results: written under another name and renamed when whole, so that no reader ever sees half a file.
#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>

namespace granular {

/// Makes the folder if need be. Throws InputError if it can't be made or written into, with the reason.
void prepareOutputFolder(const std::filesystem::path& folder);

class OutputFile {
 public:
  /// Throws InputError if the file can't be opened.
  explicit OutputFile(std::filesystem::path target);
  /// Removes what was not finished.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view text);
  void write(std::span<const std::byte> bytes);
  /// Gives the file its name. Throws InputError if it could not be written whole.
  void finish();

 private:
  std::filesystem::path path, partial;
  std::ofstream stream;
  bool finished = false;
};

}  // namespace granular
