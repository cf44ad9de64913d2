// A short fuzz run for every compiler: hands a target all files of its corpus as they are, then inputs made from them
// by seeded changes, the same ones in every run. extern/check-fuzz goes further, by coverage.
//   short_fuzz_TARGET CHANGED FOLDER...            runs the files of the folders and CHANGED inputs made from them
//   short_fuzz_TARGET --write N FILE FOLDER...     writes changed input N to FILE instead
//   short_fuzz_TARGET --only FILE                  runs one file
// What ends a run (a signal, an exception, 60 s for one input) is reported with the name of its input; exit code 1.
// Files that a target writes go to a folder of the run's own, which is removed in any case.
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <iterator>
#include <vector>

#include "fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

namespace fs = std::filesystem;

/// Inputs are no longer than those of extern/check-fuzz.
constexpr std::size_t longest = 16384;
constexpr unsigned secondsPerInput = 60;

/// The input being run, for the message when it is the last.
char running[512] = "none";

struct File {
  std::string name, content;
};

File readFile(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {path.string(), std::string(std::istreambuf_iterator<char>(file), {})};
}

/// In the order of their names: what is made of them is the same everywhere.
std::vector<File> readCorpus(const std::vector<fs::path>& folders) {
  std::vector<File> files;
  for (const fs::path& folder : folders) {
    std::vector<fs::path> paths;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
      if (entry.is_regular_file()) paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    for (const fs::path& path : paths) files.push_back(readFile(path));
  }
  return files;
}

/// Steele, Lea and Flood's SplitMix64.
class Stream {
 public:
  explicit Stream(std::uint64_t seed) : state(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = state += 0x9e3779b97f4a7c15ull;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  std::size_t below(std::size_t limit) { return limit == 0 ? 0 : bits() % limit; }

 private:
  std::uint64_t state;
};

/// One change: a bit, a byte, a number that is often a limit, a stretch out, a stretch twice, the end off, or a stretch
/// of another file.
void change(Stream& stream, const std::vector<File>& corpus, std::string& input) {
  const std::size_t at = stream.below(input.size() + 1);
  const std::size_t length = std::min<std::size_t>(1 + stream.below(16), input.size() - at);
  switch (stream.below(7)) {
    case 0:
      if (at < input.size()) input[at] = static_cast<char>(input[at] ^ (1 << stream.below(8)));
      break;
    case 1:
      if (at < input.size()) input[at] = static_cast<char>(stream.bits());
      break;
    case 2: {
      constexpr const char* telling[] = {"-1",          "0", "1e308", "nan", "inf",
                                         "99999999999", "=", "\"",    "]",   "\xff\xff\xff\xff"};
      input.replace(at, length, telling[stream.below(std::size(telling))]);
      break;
    }
    case 3:
      input.erase(at, length);
      break;
    case 4:
      input.insert(at, input.substr(at, length));
      break;
    case 5:
      if (stream.below(4) == 0) input.resize(at);
      break;
    default: {
      const std::string& other = corpus[stream.below(corpus.size())].content;
      const std::size_t from = stream.below(other.size() + 1);
      input.insert(at, other.substr(from, 1 + stream.below(64)));
    }
  }
}

/// Changed input number n: one to eight changes of a file.
File makeChanged(const std::vector<File>& corpus, std::uint64_t n) {
  Stream stream(n);
  const File& source = corpus[stream.below(corpus.size())];
  File made{"changed input " + std::to_string(n) + " (of " + source.name + ")", source.content};
  for (std::size_t changes = 1 + stream.below(8); changes > 0; --changes) change(stream, corpus, made.content);
  made.content.resize(std::min(made.content.size(), longest));
  return made;
}

void runOne(const File& file) {
  std::snprintf(running, sizeof running, "%s", file.name.c_str());
  ::alarm(secondsPerInput);
  // A copy of its exact length, so that a sanitizer sees who reads beyond it.
  const std::vector<std::uint8_t> bytes(file.content.begin(), file.content.end());
  LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
}

extern "C" void reportSignal(int signal) {
  // Nothing but calls that are safe in a handler.
  const auto say = [](const char* text) { [[maybe_unused]] const auto n = ::write(2, text, std::strlen(text)); };
  say(signal == SIGALRM ? "\nshort fuzz run: too slow: " : "\nshort fuzz run: ended by: ");
  say(running);
  say("\n");
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// Runs everything in a child whose files go to a folder of its own; true if it came to its end.
bool runInFolder(const std::vector<File>& corpus, std::uint64_t changed) {
  std::string folder = (fs::temp_directory_path() / "granular_short_fuzz_XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) {
    std::perror(folder.c_str());
    return false;
  }
  const pid_t child = ::fork();
  if (child == 0) {
    ::setenv("TMPDIR", folder.c_str(), 1);
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGALRM}) std::signal(signal, reportSignal);
    for (const File& file : corpus) runOne(file);
    for (std::uint64_t n = 0; n < changed; ++n) runOne(makeChanged(corpus, n));
    std::printf("%zu files and %llu changed inputs\n", corpus.size(), static_cast<unsigned long long>(changed));
    std::exit(0);
  }
  int status = 1;
  if (child > 0) ::waitpid(child, &status, 0);
  fs::remove_all(folder);
  return child > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const auto folders = [&](std::size_t first) {
    return std::vector<fs::path>(arguments.begin() + static_cast<std::ptrdiff_t>(first), arguments.end());
  };
  if (arguments.size() == 2 && arguments[0] == "--only") return runInFolder({readFile(arguments[1])}, 0) ? 0 : 1;
  const bool writes = arguments.size() >= 4 && arguments[0] == "--write";
  if (!writes && arguments.size() < 2) {
    std::fprintf(stderr, "usage: short_fuzz_TARGET CHANGED FOLDER... | --write N FILE FOLDER... | --only FILE\n");
    return 2;
  }
  const std::vector<File> corpus = readCorpus(folders(writes ? 3 : 1));
  if (corpus.empty()) {
    std::fprintf(stderr, "short fuzz run: there is no file in the folders given\n");
    return 2;
  }
  if (writes) {
    granular::fuzz::writeFile(arguments[2], makeChanged(corpus, std::stoull(arguments[1])).content);
    return 0;
  }
  return runInFolder(corpus, std::stoull(arguments[0])) ? 0 : 1;
}
