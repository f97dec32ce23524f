// ik_axis as CXXRTL makes it, in the shape of what Verilator makes of ik_every_node: every_node.cpp drives either.
// SPDX-License-Identifier: Apache-2.0
//
// DESIGN is the C++ of CXXRTL, W the word length, NODES the paths of the nodes as strings with commas between them.
#ifndef CXXRTL_TOP_H
#define CXXRTL_TOP_H

#include DESIGN

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

struct VerilatedContext {  // random registers at the start are Verilator's
  void randReset(int) {}
  void randSeed(int) {}
};

class Vtop {
  static constexpr size_t kFields = 6;
  static constexpr uint64_t kMask = (uint64_t{1} << W) - 1;

  cxxrtl_design::p_ik__axis core;
  cxxrtl::debug_items items;
  std::map<std::string, const cxxrtl::debug_item *> named;
  std::vector<const cxxrtl::debug_item *> shown;

  const cxxrtl::debug_item &item(const std::string &path) {
    const auto found = named.find(path);
    if (found == named.end()) {
      std::fprintf(stderr, "CXXRTL has no %s\n", path.c_str());
      std::exit(1);
    }
    return *found->second;
  }
  uint32_t read(const char *port) { return *item(port).curr; }
  void write(const char *port, uint32_t value) { *item(port).next = value; }

 public:
  explicit Vtop(VerilatedContext *) {
    core.debug_info(&items, nullptr, "");
    for (const auto &[name, parts] : items.table) {
      std::string path = name;
      std::replace(path.begin(), path.end(), ' ', '.');
      named[path] = &parts.front();
    }
    for (const char *path : {NODES}) shown.push_back(&item(path));
  }
  uint8_t clk = 0, rst = 0, in_valid = 0, tag = 0, in_ready = 0, out_valid = 0, out_tag = 0, out_flags = 0;
  std::array<uint32_t, kFields> target{}, result{};
  std::vector<uint32_t> nodes;

  void eval() {
    write("clk", clk);
    write("rst", rst);
    write("s_axis_tvalid", in_valid);
    write("s_axis_tuser", tag);
    write("m_axis_tready", 1);
    uint32_t *data = item("s_axis_tdata").next;
    std::fill_n(data, (kFields * W + 31) / 32, 0);
    for (size_t k = 0; k < kFields; ++k) {
      const uint64_t word = (target[k] & kMask) << (k * W % 32);
      data[k * W / 32] |= static_cast<uint32_t>(word);
      if (word >> 32) data[k * W / 32 + 1] |= static_cast<uint32_t>(word >> 32);
    }
    core.step();
    if (clk) return;
    in_ready = read("s_axis_tready");
    out_valid = read("m_axis_tvalid");
    out_tag = read("m_axis_tuser") & 0xff;
    out_flags = read("m_axis_tuser") >> 8;
    const uint32_t *answer = item("m_axis_tdata").curr;
    for (size_t k = 0; k < kFields; ++k) {
      uint64_t word = answer[k * W / 32];
      if (k * W % 32 + W > 32) word |= static_cast<uint64_t>(answer[k * W / 32 + 1]) << 32;
      result[k] = (word >> (k * W % 32)) & kMask;
    }
    nodes.clear();
    for (const auto *node : shown) nodes.insert(nodes.end(), node->curr, node->curr + (node->width + 31) / 32);
  }
  void final() {}
};

#endif
