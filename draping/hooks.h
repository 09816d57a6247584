// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What holds a garment by its labelled edges while it settles: springs that keep the edges' height.

#include "draping/energy/spring.h"
#include "sewing/garment.h"

#include <map>
#include <string>
#include <vector>

namespace toile {

/// Whether edges of this label carry a garment by themselves and hold it up only once friction does: in
/// GarmentCode files the waist of skirts and trousers, and the top of strapless tops.
bool carries(const std::string& label);

/// Labels of `all` that a word names: the label itself, the label without its side ("collar" for left_collar
/// and right_collar), spaces for underscores ("strapless top"), and "waist" for lower_interface. Sorted.
std::vector<std::string> labels_called(const std::string& word, const std::vector<std::string>& all);

/// Labels of a garment's borders, sorted, each once.
std::vector<std::string> labels_of(const Garment& garment);

/// Mean height, m, of the edges of each label.
std::map<std::string, double> label_heights(const Garment& garment, const Points& x,
                                            const std::vector<std::string>& labels);

/// Length, m, of the edges of a label in all, as they were cut.
double label_length(const Garment& garment, const std::string& label);

/// Hooks that hold the heights of the labelled edges with no more than `strength` newton in all.
std::vector<HookSpring> make_hooks(const Garment& garment, const std::map<std::string, double>& heights,
                                   double strength);

/// Heights of the highest and of the mean point, m; minus infinity at the top of none.
double top_height(const Points& x);
double mean_height(const Points& x);

} // namespace toile
