// instruction_sets.h: tests that run on every instruction set that vector code is compiled for.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "surface/base/instruction_sets.h"

namespace tangi {

// The parameter is the set's name: INSTANTIATE_TEST_SUITE_P(Sets, ..., every_instruction_set(), name_of_set).
class OnInstructionSet : public testing::TestWithParam<std::string> {
protected:
    void SetUp() override { use_instruction_set(GetParam()); }
    void TearDown() override { use_instruction_set(""); }
};

inline auto every_instruction_set() { return testing::ValuesIn(instruction_sets()); }
inline std::string name_of_set(const testing::TestParamInfo<std::string>& set) { return set.param; }

}  // namespace tangi
