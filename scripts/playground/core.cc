// WebAssembly interface to the CXXRTL model of ik_axis: functions called by the page.
// SPDX-License-Identifier: Apache-2.0
//
// CORE is the C++ of the design. Signals are numbered; each has a name, a width and an address of 32-bit words, lowest
// first. In each clock the page writes the inputs in place and calls settle, show and edge.
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

// Finds the signals named in the Verilog, including ports and nodes, and returns their number.
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

// Returns the words of all signals in this clock, concatenated.
EXPORT(show) uint32_t *show() {
  size_t at = 0;
  for (const Signal &signal : signals) {
    std::memcpy(&shown[at], signal.data, 4 * signal.words);
    at += signal.words;
  }
  return shown.data();
}

// Sets the clock low and updates all combinational logic.
EXPORT(settle) void settle() {
  core.p_clk.set<bool>(false);
  core.step();
}

EXPORT(edge) void edge() {
  core.p_clk.set<bool>(true);
  core.step();
}
