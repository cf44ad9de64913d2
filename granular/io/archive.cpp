#include "granular/io/archive.h"

#include <cassert>
#include <span>

#include "granular/io/digest.h"

namespace granular {

std::size_t elementSize(ElementType type) {
  switch (type) {
    case ElementType::float64:
    case ElementType::int64:
    case ElementType::uint64:
      return 8;
    case ElementType::int32:
      return 4;
    case ElementType::uint8:
    case ElementType::text:
      return 1;
  }
  return 1;
}

void Archive::put(std::string_view name, DataSet set, const void* data, const Note& note) {
  set.bytes.resize(set.rows * set.width * elementSize(set.type));
  if (!set.bytes.empty()) std::memcpy(set.bytes.data(), data, set.bytes.size());
  set.unit = note.unit;
  set.description = note.description;
  [[maybe_unused]] const bool isNew = dataSets.emplace(prefix + std::string(name), std::move(set)).second;
  assert(isNew && "two data sets of one name");
}

void Archive::failAt(std::string_view name, const std::string& why) const {
  throw InputError(origin + ": " + prefix + std::string(name) + ' ' + why);
}

const DataSet& Archive::expect(std::string_view name, ElementType type, std::uint64_t width) {
  const auto found = dataSets.find(prefix + std::string(name));
  if (found == dataSets.end()) failAt(name, "is missing");
  DataSet& set = found->second;
  if (set.type != type || set.width != width) failAt(name, "has another type than expected");
  if (set.bytes.size() != set.rows * set.width * elementSize(type)) failAt(name, "has the wrong number of bytes");
  set.read = true;
  return set;
}

void Archive::visit(std::string_view name, bool& value, const Note& note) {
  std::uint8_t byte = value ? 1 : 0;
  visit(name, byte, note);
  value = byte != 0;
}

void Archive::visit(std::string_view name, std::string& value, const Note& note) {
  if (!isLoading) {
    put(name, {ElementType::text, value.size(), 1, true, {}, {}, {}, false}, value.data(), note);
    return;
  }
  const DataSet& set = expect(name, ElementType::text, 1);
  value.assign(reinterpret_cast<const char*>(set.bytes.data()), set.bytes.size());
}

void Archive::visit(std::string_view name, std::vector<std::string>& value, const Note& note) {
  // One column of bytes, a zero behind each text.
  std::vector<std::uint8_t> bytes;
  if (!isLoading)
    for (const std::string& text : value) {
      bytes.insert(bytes.end(), text.begin(), text.end());
      bytes.push_back(0);
    }
  visit(name, bytes, note);
  if (!isLoading) return;
  value.clear();
  std::string text;
  for (const std::uint8_t byte : bytes) {
    if (byte != 0) {
      text += static_cast<char>(byte);
      continue;
    }
    value.push_back(std::move(text));
    text.clear();
  }
  if (!text.empty()) failAt(name, "does not end with a zero");
}

bool Archive::has(std::string_view name) const {
  const std::string path = prefix + std::string(name);
  if (dataSets.contains(path)) return true;
  const auto next = dataSets.lower_bound(path + '/');
  return next != dataSets.end() && next->first.starts_with(path + '/');
}

std::uint64_t Archive::rowsOf(std::string_view name) const {
  const auto found = dataSets.find(prefix + std::string(name));
  return found == dataSets.end() ? 0 : found->second.rows;
}

void Archive::requireAllRead() const {
  for (const auto& [path, set] : dataSets)
    if (!set.read) throw InputError(origin + ": " + path + " is unknown to this version");
}

std::string Archive::digest() const {
  Digest digest;
  const auto addText = [&](std::string_view text) {
    digest.add(std::as_bytes(std::span(text)));
    const std::byte end{0};
    digest.add({&end, 1});
  };
  for (const auto& [path, set] : dataSets) {
    addText(path);
    const std::uint64_t shape[] = {static_cast<std::uint64_t>(set.type), set.rows, set.width, set.bytes.size()};
    digest.add(std::as_bytes(std::span(shape)));
    digest.add(set.bytes);
  }
  return digest.finishHex();
}

}  // namespace granular
