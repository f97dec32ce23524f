// Drives arguments through a divider, square root or reciprocal root, one per clock, and checks each result.
// SPDX-License-Identifier: Apache-2.0
//
//     Vtop FIRST END BITS LAT NAME=VALUE ...
//
// Built with -DCORE=Div, Root or Rsqrt around ik_div, ik_root or ik_rsqrt, whose parameters are NAME=VALUE. BITS is the
// total width of all arguments, LAT the latency in clocks. Drives vectors FIRST to END - 1 of the 2^BITS and prints the
// number of failures; a second line describes the first one. Exit status: 0 no failure, 1 failures, 2 usage.
//
// Checks are integer inequalities from the definition in the module's first line; they share no code with the model.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "Vtop.h"
#include "verilated.h"

using Wide = __int128;

// Parameters from the command line.
struct Parameters {
  int count;
  char** words;

  int operator[](const std::string& name) const {
    for (int k = 0; k < count; ++k) {
      const std::string word = words[k];
      if (word.rfind(name + "=", 0) == 0) return std::atoi(word.c_str() + name.size() + 1);
    }
    std::fprintf(stderr, "no parameter %s\n", name.c_str());
    std::exit(2);
  }
};

uint64_t ones(int width) { return (uint64_t{1} << width) - 1; }

int64_t to_signed(uint64_t bits, int width) {
  return static_cast<int64_t>(bits << (64 - width)) >> (64 - width);
}

std::string text(int64_t value) { return std::to_string(value); }

// q = floor(n 2^SH / d), saturated; if d <= 0, saturated by the sign of n. The argument is {n, d}.
struct Div {
  const int nw, dw, sh, qw;

  explicit Div(const Parameters& p) : nw(p["NW"]), dw(p["DW"]), sh(p["SH"]), qw(p["QW"]) {}

  int64_t n(uint64_t argument) const { return to_signed(argument >> dw, nw); }
  int64_t d(uint64_t argument) const { return to_signed(argument, dw); }

  template <class Top>
  void drive(Top& top, uint64_t argument) const {
    top.n = (argument >> dw) & ones(nw);
    top.d = argument & ones(dw);
  }

  // {ovf, q}
  template <class Top>
  uint64_t answer(const Top& top) const {
    return uint64_t{top.ovf} << qw | top.q;
  }

  bool right(uint64_t argument, uint64_t seen) const {
    const int64_t most = ones(qw - 1), least = -most - 1;
    const int64_t dividend = n(argument) * (int64_t{1} << sh), divisor = d(argument);
    bool over = divisor <= 0;
    int64_t q = dividend < 0 ? least : most;
    if (!over) {
      const int64_t floor = dividend / divisor - (dividend % divisor < 0);  // C++ rounds toward 0
      over = floor < least || floor > most;
      if (!over) q = floor;
    }
    return seen == (uint64_t{over} << qw | (q & ones(qw)));
  }

  std::string words(uint64_t argument) const { return "n=" + text(n(argument)) + " d=" + text(d(argument)); }
  std::string words_of_answer(uint64_t a) const { return "q=" + text(to_signed(a, qw)) + " ovf=" + text(a >> qw); }
};

// q = floor(sqrt(n 2^SH)), saturated at 2^(QW-1) - 1; 0 if n < 0.
struct Root {
  const int nw, sh, qw;

  explicit Root(const Parameters& p) : nw(p["NW"]), sh(p["SH"]), qw(p["QW"]) {}

  template <class Top>
  void drive(Top& top, uint64_t argument) const {
    top.n = argument & ones(nw);
  }

  // {neg, q}
  template <class Top>
  uint64_t answer(const Top& top) const {
    return uint64_t{top.neg} << qw | top.q;
  }

  bool right(uint64_t argument, uint64_t seen) const {
    const int64_t n = to_signed(argument, nw);
    if (n < 0) return seen == uint64_t{1} << qw;
    const Wide radicand = Wide{n} << sh, q = seen, most = ones(qw - 1);
    return q <= most && q * q <= radicand && (q == most || radicand < (q + 1) * (q + 1));
  }

  std::string words(uint64_t argument) const { return "n=" + text(to_signed(argument, nw)); }
  std::string words_of_answer(uint64_t a) const { return "q=" + text(to_signed(a, qw)) + " neg=" + text(a >> qw); }
};

// |y - 1/(2 sqrt V)| < 1 LSB for every V in [m, m + 1); as integers, 1/(2 sqrt m) is sqrt(S / m) LSB with S = 2^(3F+1).
struct Rsqrt {
  const int f;

  explicit Rsqrt(const Parameters& p) : f(p["F"]) {}

  // Below 1/4 the second bit counts as set.
  uint64_t mantissa(uint64_t argument) const { return argument >> (f + 1) ? argument : argument | uint64_t{1} << (f + 1); }

  template <class Top>
  void drive(Top& top, uint64_t argument) const {
    top.m_next = argument;
    top.twice = 0;
  }

  template <class Top>
  uint64_t answer(const Top& top) const {
    return top.y;
  }

  bool right(uint64_t argument, uint64_t seen) const {
    const Wide m = mantissa(argument), y = seen, s = Wide{1} << (3 * f + 1);
    return (y - 1) * (y - 1) * (m + 1) <= s && s < (y + 1) * (y + 1) * m;
  }

  std::string words(uint64_t argument) const { return "m=" + text(argument); }
  std::string words_of_answer(uint64_t a) const { return "y=" + text(a); }
};

int main(int argc, char** argv) {
  if (argc < 5) return 2;
  const uint64_t first = std::strtoull(argv[1], nullptr, 10), end = std::strtoull(argv[2], nullptr, 10);
  const int bits = std::atoi(argv[3]);
  const uint64_t latency = std::strtoull(argv[4], nullptr, 10);
  if (first >= end || bits < 1 || bits > 62 || latency < 1) return 2;
  const CORE core{Parameters{argc - 5, argv + 5}};

  // Multiplication by an odd number is a permutation: each argument occurs once, and successive arguments differ widely.
  const auto argument = [bits](uint64_t number) { return number * 0x9e3779b97f4a7c15 & ones(bits); };

  VerilatedContext context;
  Vtop top{&context};
  top.clk = 0;
  top.eval();
  uint64_t vectors = 0, failures = 0;
  std::string failure;
  for (uint64_t in = first; vectors < end - first; ++in) {
    core.drive(top, argument(in));
    top.clk = 1;
    top.eval();
    top.clk = 0;
    top.eval();
    if (in - first + 1 < latency) continue;
    const uint64_t number = in + 1 - latency, asked = argument(number), seen = core.answer(top);
    ++vectors;
    if (!core.right(asked, seen) && ++failures == 1) {
      failure = "vector " + text(number) + " " + core.words(asked) + ": " + core.words_of_answer(seen);
    }
  }
  std::printf("%s\n%s", text(failures).c_str(), failure.c_str());
  return failures != 0;
}
