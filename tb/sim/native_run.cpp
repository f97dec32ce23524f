// Runs targets through ik_axis without stalls and compares each named node, in its own clock, with the model's words.
// SPDX-License-Identifier: Apache-2.0
//
//     Vtop RESULTS < STREAM
//
// The top is the wrapper of native_run.py; its port `nodes` holds each node, aligned to 32 bits. STREAM and RESULTS are
// 64-bit little-endian words. STREAM begins with the word length, the numbers of input words, result words and nodes,
// and clock and width of each node. Frames follow: a count n, then columns of n words for input words, result words,
// flags and nodes. A node has a column per 64 bits. A frame with n = 0 ends STREAM. RESULTS gets the columns of each
// frame's result words (unsigned) and flags.
//
// Prints "done TARGETS LATENCY CLOCKS BITS": LATENCY from first target in to first result out, CLOCKS to the last one,
// BITS that differ. Prints "differs NODE TARGET CLOCK RTL MODEL", words in hexadecimal, for the first 1000 differences.
// Exits with 1 if the stream of results is wrong, with 2 on bad input; the reason is on stderr.
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "Vtop.h"
#include "verilated.h"
#if VM_COVERAGE
#include "verilated_cov.h"
#endif

namespace {

constexpr int kKept = 1000, kMostClocks = 20000, kAfterLast = 8;
constexpr uint64_t kTags = 256;

[[noreturn]] void stop(int status, const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  std::exit(status);
}

uint64_t read_word() {
  uint64_t word;
  if (std::fread(&word, sizeof word, 1, stdin) != 1) stop(2, "the stream ends early");
  return word;
}

uint64_t ones(unsigned width) { return width >= 64 ? ~uint64_t{0} : (uint64_t{1} << width) - 1; }

// Up to 64 bits of a node's word, compared with one column.
struct Limb {
  unsigned node, time, word;  // word: index of the 32-bit word in the port `nodes`
  bool wide;                  // more than 32 bits
  uint64_t mask;
  size_t column;
};

struct Frame {
  uint64_t first, count;
  std::vector<uint64_t> words, results;

  Frame(uint64_t first_, uint64_t count_, size_t columns, size_t out) : first(first_), count(count_) {
    words.resize(columns * count);
    results.resize((out + 1) * count);
    if (std::fread(words.data(), sizeof(uint64_t), words.size(), stdin) != words.size()) stop(2, "a frame ends early");
  }
  uint64_t at(size_t column, uint64_t row) const { return words[column * count + row]; }
};

// Target in flight. frame is null if no target was admitted in this clock.
struct Flying {
  Frame* frame = nullptr;
  uint64_t row = 0, clock = 0;
};

struct Difference {
  unsigned node;
  uint64_t target, clock;
  std::string rtl, model;
};

std::string hex(uint64_t word) {
  char digits[9];
  std::snprintf(digits, sizeof digits, "%08x", static_cast<unsigned>(word));
  return digits;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  std::FILE* results = std::fopen(argv[1], "wb");
  if (!results) stop(2, std::string("cannot write ") + argv[1]);

  const unsigned width = read_word();
  const uint64_t mask = ones(width);
  struct Node {
    unsigned width, word;
    size_t column;
  };
  const size_t inputs = read_word(), outputs = read_word();
  const size_t flags = inputs + outputs;  // column of the flags, before the nodes
  std::vector<Node> nodes(read_word());
  std::vector<std::vector<Limb>> by_time;
  size_t columns = flags + 1;
  unsigned port = 0;
  for (unsigned k = 0; k < nodes.size(); ++k) {
    const unsigned time = read_word(), bits = read_word();
    nodes[k] = {bits, port, columns};
    if (by_time.size() <= time) by_time.resize(time + 1);
    for (unsigned low = 0; low < bits; low += 64) {
      by_time[time].push_back({k, time, port + low / 32, bits - low > 32, ones(bits - low), columns++});
    }
    port += (bits + 31) / 32;
  }

  VerilatedContext context;
#if VM_COVERAGE
  context.commandArgs(argc, argv);
#endif
  context.randReset(2);  // random initial registers, as in a chip
  context.randSeed(1);
  const auto owner = std::make_unique<Vtop>(&context);
  Vtop& top = *owner;
  top.clk = 0;
  top.in_valid = 0;
  top.rst = 1;
  auto edge = [&] {
    top.clk = 1;
    top.eval();
    top.clk = 0;
  };
  for (int k = 0; k < 4; ++k) {
    top.eval();
    edge();
  }
  top.rst = 0;

  std::deque<std::unique_ptr<Frame>> frames;
  Frame* frame = nullptr;  // frame of the target at the input
  uint64_t row = 0, sent = 0, left = 0;
  bool more = true;
  auto next_frame = [&] {
    const uint64_t count = read_word();
    more = count != 0;
    row = 0;
    if (more) frames.push_back(std::make_unique<Frame>(sent, count, columns, outputs));
    frame = more ? frames.back().get() : nullptr;
  };
  next_frame();

  std::vector<Flying> ring(std::bit_ceil(by_time.size() + 1));
  std::deque<Flying> due;
  std::vector<Difference> differences;
  uint64_t bits = 0, first_in = 0, last_out = 0, latency = 0, quiet = 0;
  uint64_t clock = 6;  // clock of the first target, numbered as in the cocotb bench
  for (unsigned after = 0; after < kAfterLast; ++clock) {
    top.in_valid = more;
    if (more) {
      for (size_t k = 0; k < inputs; ++k) top.target[k] = frame->at(k, row) & mask;
      top.tag = sent % kTags;
    }
    top.eval();

    // admission
    Flying& here = ring[clock % ring.size()];
    here = {};
    if (more && top.in_ready) {
      here = {frame, row, clock};
      due.push_back(here);
      if (sent++ == 0) first_in = clock;
    }

    // nodes
    for (size_t time = 0; time < by_time.size() && time <= clock; ++time) {
      const Flying& target = ring[(clock - time) % ring.size()];
      if (!target.frame) continue;
      const uint64_t* expected = target.frame->words.data() + target.row;
      for (const Limb& limb : by_time[time]) {
        uint64_t word = top.nodes[limb.word];
        if (limb.wide) word |= static_cast<uint64_t>(top.nodes[limb.word + 1]) << 32;
        const uint64_t wrong = (word ^ expected[limb.column * target.frame->count]) & limb.mask;
        if (!wrong) continue;
        bits += std::popcount(wrong);
        if (differences.size() >= kKept) continue;
        const uint64_t number = target.frame->first + target.row;
        if (!differences.empty() && differences.back().node == limb.node && differences.back().target == number) continue;
        const Node& node = nodes[limb.node];
        std::string rtl, model;
        for (unsigned k = (node.width + 31) / 32; k-- > 0;) {
          const uint64_t limbs = target.frame->at(node.column + k / 2, target.row);
          rtl += hex(top.nodes[node.word + k]);
          model += hex((k % 2 ? limbs >> 32 : limbs) & ones(node.width - 32 * k) & ones(32));
        }
        differences.push_back({limb.node, number, clock, rtl, model});
      }
    }

    // departure
    ++quiet;
    if (top.out_valid) {
      if (due.empty()) stop(1, "a result with tag " + std::to_string(top.out_tag) + " without a target");
      const Flying target = due.front();
      due.pop_front();
      if (top.out_tag != left % kTags) {
        stop(1, "target " + std::to_string(left) + ": the result has tag " + std::to_string(top.out_tag));
      }
      if (left == 0) latency = clock - target.clock;
      if (clock - target.clock != latency) {
        stop(1, "target " + std::to_string(left) + ": " + std::to_string(clock - target.clock) + " clocks, the first took " +
                    std::to_string(latency));
      }
      Frame& of = *target.frame;
      for (size_t k = 0; k < outputs; ++k) of.results[k * of.count + target.row] = top.result[k];
      of.results[outputs * of.count + target.row] = top.out_flags;
      bool differs = top.out_flags != of.at(flags, target.row);
      for (size_t k = 0; k < outputs; ++k) differs |= top.result[k] != (of.at(inputs + k, target.row) & mask);
      if (differs && !bits) stop(1, "target " + std::to_string(left) + ": its nodes are right, its result or flags are not");
      ++left;
      last_out = clock;
      quiet = 0;
      if (target.row + 1 == of.count) {
        if (std::fwrite(of.results.data(), sizeof(uint64_t), of.results.size(), results) != of.results.size()) {
          stop(2, "cannot write results");
        }
        frames.pop_front();
      }
    }
    if (!more && due.empty()) ++after;  // no further result may follow
    if (quiet > kMostClocks) stop(1, "no result for " + std::to_string(kMostClocks) + " clocks");

    if (here.frame && ++row == frame->count) next_frame();
    edge();
  }
  if (std::fclose(results)) stop(2, "cannot write results");
  top.final();
#if VM_COVERAGE
  context.coveragep()->write();
#endif
  std::printf("done %llu %llu %llu %llu\n", static_cast<unsigned long long>(left), static_cast<unsigned long long>(latency),
              static_cast<unsigned long long>(left ? last_out - first_in + 1 : 0), static_cast<unsigned long long>(bits));
  for (const Difference& d : differences) {
    std::printf("differs %u %llu %llu %s %s\n", d.node, static_cast<unsigned long long>(d.target),
                static_cast<unsigned long long>(d.clock), d.rtl.c_str(), d.model.c_str());
  }
  return 0;
}
