// The scene parser: any text, and any overrides behind zero bytes, gives a scene or an InputError.
#include "fuzz/fuzz_input.h"
#include "granular/core/errors.h"
#include "granular/io/scene_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  std::vector<std::string> parts;
  for (std::size_t end; (end = rest.find('\0')) != std::string_view::npos; rest.remove_prefix(end + 1))
    parts.emplace_back(rest.substr(0, end));
  parts.emplace_back(rest);
  try {
    granular::parseScene(parts[0], granular::fuzz::scratch() / "scene.toml", {parts.begin() + 1, parts.end()});
  } catch (const granular::InputError&) {
  }
  return 0;
}
