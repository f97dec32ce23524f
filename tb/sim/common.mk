# Parses the headers of $(COMMON), a copy of common.h, once: 3 s less for each build.
# SPDX-License-Identifier: Apache-2.0
Vtop__ALL.o verilator.o: | $(COMMON).gch
$(COMMON).gch: $(COMMON)
	$(CXX) $(CXXFLAGS) $(CPPFLAGS) $(OPT_FAST) -x c++-header $< -o $@.$$$$ && mv $@.$$$$ $@
