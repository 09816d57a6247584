// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/memory.h"

#include <catch2/catch.hpp>

#include <memory>

using namespace toile;

TEST_CASE("memory in use follows what is taken and returned") {
    const MemoryUse before = memory_use();
    REQUIRE(before.now > 1e6);
    CHECK(before.peak >= before.now);
    constexpr std::size_t size = 100'000'000;
    auto block = std::make_unique<char[]>(size); // written, so that it is there
    const MemoryUse with = memory_use();
    CHECK(with.now > before.now + 0.9 * size);
    block.reset();
    const MemoryUse after = memory_use();
    CHECK(after.now < before.now + 0.1 * size);
    CHECK(after.peak > before.now + 0.9 * size);
}
