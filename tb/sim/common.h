// Headers that all files of a cocotb build under Verilator include.
// SPDX-License-Identifier: Apache-2.0
#ifndef IK_COMMON
#define IK_COMMON
#include <memory>
#include <string>
#include "verilated.h"
#include "verilated_dpi.h"
#include "verilated_vpi.h"
#endif
