// SPDX-License-Identifier: Apache-2.0
// Testbench of the LiteX SoC: a clock, and every byte of the UART on standard output. Exit status 1 unless the program
// finishes within LATEST clocks.
#include <cstdio>

#include "Vtop.h"
#include "verilated.h"

int main() {
    VerilatedContext context;
    Vtop soc(&context);
    soc.serial_source_ready = 1;
    for (long clock = 0; clock < LATEST && !context.gotFinish(); clock++) {
        soc.sys_clk = 0;
        soc.eval();
        if (soc.serial_source_valid) std::putchar(soc.serial_source_data);
        soc.sys_clk = 1;
        soc.eval();
    }
    return !context.gotFinish();
}
