// What this machine gives: registers full of numbers added, multiplied, divided, rooted, shuffled, loaded and stored
// per nanosecond, bytes per nanosecond from each level of memory, and lines of it in a scattered order. One JSON object
// on stdout; benchmarks/roofline.py holds kernels against it.
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "granular/core/wide.h"

namespace {

using granular::Wide;
using granular::wideSize;

/// The compiler must make this value, and knows nothing about it afterwards.
void touch(Wide& x) {
#if defined(__AVX__)
  asm volatile("" : "+v"(x));
#else
  asm volatile("" : "+x"(x));
#endif
}

double now() {
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Calls of work(), which does `amount` of something, per nanosecond, the fastest of several rounds.
template <class Work>
double perNanosecond(double amount, Work&& work) {
  double best = 0;
  for (int round = 0; round < 7; ++round) {
    const double began = now();
    double done = 0;
    while (now() - began < 5e6) {
      for (int k = 0; k < 16; ++k) work();
      done += 16 * amount;
    }
    best = std::max(best, done / (now() - began));
  }
  return best;
}

/// Registers per nanosecond of an operation on two of twelve independent registers.
template <class Operation>
double throughput(Operation&& operate) {
  constexpr int length = 64;
  return perNanosecond(12 * length, [&] {
    Wide a = granular::spread(1.25), b = a, c = a, d = a, e = a, f = a, g = a, h = a, i = a, j = a, k = a, l = a;
    for (int n = 0; n < length; ++n) {
      operate(a, b);
      operate(c, d);
      operate(e, f);
      operate(g, h);
      operate(i, j);
      operate(k, l);
      touch(a), touch(b), touch(c), touch(d), touch(e), touch(f);
      touch(g), touch(h), touch(i), touch(j), touch(k), touch(l);
    }
  });
}

/// Bytes read and written per nanosecond by y = a x + y over so many bytes altogether.
double stream(std::size_t bytes) {
  const std::size_t count = bytes / 2 / sizeof(double) / wideSize * wideSize;
  std::vector<double> x(count, 1.0), y(count, 2.0);
  const Wide a = granular::spread(1e-9);
  return perNanosecond(3.0 * 8 * static_cast<double>(count), [&] {
    for (std::size_t k = 0; k < count; k += wideSize) {
      Wide sum = granular::loadWide(&y[k]) + a * granular::loadWide(&x[k]);
      touch(sum);
      granular::storeWide(sum, &y[k]);
    }
  });
}

/// Lines of 64 bytes read (updates: and written back) per nanosecond, in a scattered order over so many bytes: each
/// address is known long before, as those of a step's pairs are.
double scattered(std::size_t bytes, bool updates) {
  constexpr std::size_t line = 8, stride = 40503;  // numbers; odd, so that every line of a power of two is met
  const std::size_t lines = bytes / (line * sizeof(double));
  std::vector<double> numbers(lines * line, 1.0);
  std::size_t next = 0;
  double sum = 0;
  const double rate = perNanosecond(4096, [&] {
    for (std::size_t k = 0; k < 4096; ++k) {
      next = (next + stride) & (lines - 1);
      double& number = numbers[next * line];
      sum += number;
      if (updates) number = 2.0;
    }
  });
  asm volatile("" : : "m"(sum));
  return rate;
}

}  // namespace

int main() {
  const Wide one = granular::spread(1.0000001), half = granular::spread(0.99999);
  alignas(64) static double memory[64 * wideSize];
  std::string text = "{\n \"numbers_per_register\": " + std::to_string(wideSize);
  const auto add = [&](const char* name, double value) {
    char line[96];
    std::snprintf(line, sizeof line, ",\n \"%s\": %.4g", name, value);
    text += line;
  };
  add("add_or_multiply_per_ns", throughput([&](Wide& x, Wide& y) {
        x = x * half;
        y = y + one;
      }));
  add("divide_per_ns", throughput([&](Wide& x, Wide& y) {
        x = one / x;
        y = one / y;
      }));
  add("root_per_ns", throughput([&](Wide& x, Wide& y) {
        x = granular::squareRoot(x);
        y = granular::squareRoot(y);
      }));
  add("load_per_ns", perNanosecond(64, [&] {
        for (std::size_t k = 0; k < 64; ++k) {
          Wide x = granular::loadWide(memory + k * wideSize);
          touch(x);
        }
      }));
  add("store_per_ns", perNanosecond(64, [&] {
        for (std::size_t k = 0; k < 64; ++k) {
          granular::storeWide(one, memory + k * wideSize);
          asm volatile("" : : : "memory");
        }
      }));
  for (const auto& [name, bytes] : {std::pair{"stream_16_kB_bytes_per_ns", std::size_t{16} << 10},
                                    std::pair{"stream_512_kB_bytes_per_ns", std::size_t{512} << 10},
                                    std::pair{"stream_8_MB_bytes_per_ns", std::size_t{8} << 20},
                                    std::pair{"stream_256_MB_bytes_per_ns", std::size_t{256} << 20}}) {
    add(name, stream(bytes));
  }
  constexpr std::size_t large = std::size_t{256} << 20;
  add("scattered_lines_read_per_ns", scattered(large, false));
  add("scattered_lines_updated_per_ns", scattered(large, true));
  std::puts((text + "\n}").c_str());
  return 0;
}
