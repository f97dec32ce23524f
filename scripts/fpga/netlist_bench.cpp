// Drive the RTL and its mapped netlist with the same pins; print the number of clocks in which their outputs differ.
// SPDX-License-Identifier: Apache-2.0
//
// Standard input: a 64-bit word per clock, the pins of `in`. Arguments: clocks before the comparison; output pin for
// a valid result; input pin that accepts it. Output: clocks compared, clocks that differ, the first of these, results.
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "Vtop.h"
#include "verilated.h"

int main(int, char **arguments) {
    const auto number = [&](int k) { return strtoul(arguments[k], nullptr, 10); };
    const unsigned long settle = number(1), valid = number(2), ready = number(3);
    VerilatedContext context;
    context.randReset(2);  // random initial values, where the model is compiled for them
    context.randSeed(1);
    Vtop top(&context);
    unsigned long clock = 0, differ = 0, first = 0, results = 0;
    uint64_t before = 0;  // the core's input pins before the clock's edge
    for (uint64_t pins; fread(&pins, sizeof pins, 1, stdin) == 1; before = pins, clock++) {
        top.in = pins;
        for (int level : {0, 1}) {
            top.clk = level;
            top.eval();
        }
        if (clock < settle) continue;
        results += top.rtl >> valid & before >> ready & 1;
        if (top.rtl != top.gate && !differ++) first = clock;
    }
    printf("%lu %lu %lu %lu\n", clock - settle, differ, first, results);
}
