// The checkpoint reader: any file gives an archive or an InputError. The first byte chooses: 0, the file as it is; else
// what stands behind the first block is covered by a digest made anew, so that the bytes get past it to HDF5.
#include <fmt/format.h>

#include <span>

#include "fuzz/fuzz_input.h"
#include "granular/core/errors.h"
#include "granular/io/checkpoint.h"
#include "granular/io/digest.h"

namespace {

constexpr std::size_t blockSize = 512;

std::string vouchFor(std::string_view file) {
  std::string out(file);
  out.resize(std::max(out.size(), blockSize), ' ');
  granular::Digest digest;
  digest.add(std::as_bytes(std::span(out).subspan(blockSize)));
  std::string block = fmt::format("granular checkpoint {}\nlength {}\nsha256 {}\nHDF5 from byte {} on.\n",
                                  granular::checkpointVersion, out.size() - blockSize, digest.finishHex(), blockSize);
  block.resize(blockSize, ' ');
  block.back() = '\n';
  return out.replace(0, blockSize, block);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  granular::fuzz::Input input(data, size);
  const bool vouched = input.take<std::uint8_t>() != 0;
  const auto path = granular::fuzz::scratch() / "checkpoint.h5";
  granular::fuzz::writeFile(path, vouched ? vouchFor(input.rest()) : std::string(input.rest()));
  try {
    granular::loadCheckpoint(path).digest();
  } catch (const granular::InputError&) {
  }
  return 0;
}
