// The core for a page: what CXXRTL made of ik_axis, behind a few functions that a page can call.
// SPDX-License-Identifier: Apache-2.0
//
// CORE is the C++ of the design. Signals are known by number: name, width, and the place of their words of 32 bits, the
// lowest first. The page writes the inputs where they are, settles the clock, looks, and gives the edge.
#include CORE

#include <cstring>
#include <string>
#include <vector>

namespace {

struct Signal {
  std::string name;
  size_t width, words;
  uint32_t *data;
};

cxxrtl_design::p_ik__axis core;
cxxrtl::debug_items items;
std::vector<Signal> signals;
std::vector<uint32_t> shown;

}  // namespace

#define EXPORT(name) extern "C" __attribute__((export_name(#name)))

// Finds the signals that the Verilog names, ports and nodes among them, and returns how many there are.
EXPORT(begin) int begin() {
  core.debug_info(&items, nullptr, "");
  size_t words = 0;
  for (auto &[name, parts] : items.table) {
    const auto &item = parts.front();
    const bool own = name.find('$') == std::string::npos && name.find('\\') == std::string::npos;
    if (!own || parts.size() != 1 || item.type == cxxrtl::debug_item::MEMORY) continue;
    const size_t chunks = (item.width + 31) / 32;
    signals.push_back({name, item.width, chunks, item.curr});
    words += chunks;
  }
  shown.resize(words);
  return static_cast<int>(signals.size());
}

EXPORT(name) const char *name(int k) { return signals[k].name.c_str(); }
EXPORT(width) int width(int k) { return static_cast<int>(signals[k].width); }
EXPORT(data) uint32_t *data(int k) { return signals[k].data; }

// The words of all signals, one after the other, as they stand in this clock.
EXPORT(show) uint32_t *show() {
  size_t at = 0;
  for (const Signal &signal : signals) {
    std::memcpy(&shown[at], signal.data, 4 * signal.words);
    at += signal.words;
  }
  return shown.data();
}

// The clock is low and all that depends on the inputs follows.
EXPORT(settle) void settle() {
  core.p_clk.set<bool>(false);
  core.step();
}

EXPORT(edge) void edge() {
  core.p_clk.set<bool>(true);
  core.step();
}
