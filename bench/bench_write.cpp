// SPDX-License-Identifier: GPL-3.0-or-later
// How long a garment of 14,400 triangles takes to be written in every format, read back, and drawn.
#include "geometry/parallel.h"
#include "io/preview.h"
#include "io/read_garment.h"
#include "io/write_garment.h"
#include "sewing/form.h"
#include "tests/support/skirt.h"
#include "tests/support/temp_folder.h"

#include <chrono>
#include <cstdio>

using namespace toile;

namespace {

template <class Work> void report(const char* what, Work&& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf("%-20s %.3f s\n", what, seconds.count());
}

} // namespace

int main() {
    const test::TempFolder folder;
    const auto skirt = test::make_skirt(60, 60, 0.2, 1.0, 0.5);
    const TriMesh body = make_form({});
    std::printf("%zu triangles, body of %zu, %d threads\n", skirt.garment.triangles.size(),
                body.triangles.size(), threads());
    report("write OBJ", [&] { write_garment(folder / "a.obj", skirt.garment, skirt.x); });
    report("read OBJ", [&] { read_garment(folder / "a.obj"); });
    report("write GLB", [&] { write_garment(folder / "a.glb", skirt.garment, skirt.x); });
    report("read GLB", [&] { read_garment(folder / "a.glb"); });
    report("preview, 900 high", [&] { write_preview(folder / "a.png", skirt.garment, skirt.x, body); });
}
