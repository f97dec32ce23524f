// Every input of ik_lean at a very small word length, one a clock, against the model's answers in a file.
// SPDX-License-Identifier: Apache-2.0
//
// Target number n has the input bits n. The file holds a 32-bit word a target: six result words, lowest first, the flags
// above them. Prints "targets failures" and the first few that differ.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "Vtop.h"
#include "verilated.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const int width = std::atoi(argv[1]);
  std::FILE* file = std::fopen(argv[2], "rb");
  if (!file) return 2;
  std::vector<uint32_t> expected(1u << (6 * width));
  const size_t read = std::fread(expected.data(), sizeof(uint32_t), expected.size(), file);
  std::fclose(file);
  if (read != expected.size()) return 2;

  VerilatedContext context;
  Vtop top{&context};
  auto clock = [&] {
    top.clk = 1;
    top.eval();
    top.clk = 0;
    top.eval();
  };
  top.rst = 1;
  top.in_valid = 0;
  top.in_tag = 0;
  clock();
  clock();
  top.rst = 0;

  uint64_t failures = 0;
  size_t out = 0;
  for (size_t in = 0; out < expected.size() && in < expected.size() + 1000; ++in) {
    top.in_valid = in < expected.size();
    top.in_data = static_cast<uint32_t>(in);
    top.in_tag = in & 0xff;
    clock();
    if (!top.out_valid) continue;
    const uint32_t answer = static_cast<uint32_t>(top.out_data) | static_cast<uint32_t>(top.out_flags) << (6 * width);
    if (answer != expected[out] || top.out_tag != (out & 0xff)) {
      if (++failures <= 5) {
        std::fprintf(stderr, "target %zu: %08x, model %08x, tag %02x\n", out, answer, expected[out], top.out_tag);
      }
    }
    ++out;
  }
  std::printf("%zu %llu\n", out, static_cast<unsigned long long>(failures));
  return failures != 0 || out != expected.size();
}
