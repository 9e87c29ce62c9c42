// instruction_sets.h: the sets of vector instructions that code was compiled for and this processor has.
#pragma once

#include <string>
#include <vector>

namespace tangi {

// Instruction sets that the kernel can use on this machine, best first, and which one it uses from now on
// (for tests and benchmarks; not while a fit runs). Sets with fused multiplication (AVX2, AVX-512, NEON) give
// the same bits; others differ by rounding.
std::vector<std::string> instruction_sets();
void use_instruction_set(const std::string& name);  // empty: the best again

}  // namespace tangi
