// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/colours.h"

#include <cmath>

namespace toile {

Vec3 panel_colour(int panel) {
    // Steps of the golden section never repeat and keep successive values far apart.
    const double step = std::fmod(0.6180339887498949 * panel, 1.0);
    const Vec3 dark(0.085, 0.185, 0.335), light(0.165, 0.300, 0.440);
    return dark + step * (light - dark);
}

Vec3 body_colour() {
    return {0.60, 0.53, 0.47};
}

double srgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

} // namespace toile
