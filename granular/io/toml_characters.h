// What toml++ 3.3 must not be shown: a letter beyond ASCII where it looks for white space, keys and values. Its table
// of white space has entries that lead nowhere, which is undefined behaviour, not an error.
#pragma once

#include <optional>
#include <string_view>

namespace granular {

/// The first character beyond ASCII outside of strings and comments, or first after a line's end that a string leaves
/// out: its offset in bytes. A byte order mark at the beginning is none.
inline std::optional<std::size_t> findStrayCharacter(std::string_view text) {
  const auto isStray = [&](std::size_t k) { return k < text.size() && static_cast<unsigned char>(text[k]) >= 0x80; };
  const auto startsWith = [&](std::size_t k, std::string_view what) { return text.substr(k, what.size()) == what; };
  std::size_t k = startsWith(0, "\xEF\xBB\xBF") ? 3 : 0;
  while (k < text.size()) {
    const char c = text[k];
    if (isStray(k)) return k;
    if (c == '#') {
      k = text.find('\n', k);
    } else if (c == '"' || c == '\'') {
      // To the end of the string; one on a single line ends there at the latest.
      const std::string_view three = c == '"' ? "\"\"\"" : "'''";
      const bool many = startsWith(k, three);
      for (k += many ? 3 : 1; k < text.size(); ++k) {
        if (many ? startsWith(k, three) : text[k] == c || text[k] == '\n') break;
        if (c != '"' || text[k] != '\\') continue;
        const std::size_t next = text.find_first_not_of(" \t\r\n", k + 1);
        const bool leavesOut = many && text.substr(k, next - k).find('\n') != std::string_view::npos;
        if (leavesOut && next != std::string_view::npos && isStray(next)) return next;
        ++k;
      }
      k += many ? 3 : 1;
    } else {
      ++k;
    }
  }
  return std::nullopt;
}

}  // namespace granular
