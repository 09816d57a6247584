// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/hooks.h"

#include <algorithm>
#include <limits>
#include <set>

namespace toile {

namespace {

constexpr double give = 0.01; // m by which a hook at its full strength yields

std::string without_side(const std::string& label) {
    for (const char* side : {"left_", "right_"})
        if (label.starts_with(side)) return label.substr(std::string(side).size());
    return label;
}

} // namespace

bool carries(const std::string& label) {
    return label == "lower_interface" || label == "strapless_top";
}

std::vector<std::string> labels_called(const std::string& word, const std::vector<std::string>& all) {
    std::string asked = word;
    std::replace(asked.begin(), asked.end(), ' ', '_');
    std::set<std::string> called;
    for (const std::string& label : all)
        if (label == word || label == asked || without_side(label) == asked ||
            (asked == "waist" && label == "lower_interface"))
            called.insert(label);
    return {called.begin(), called.end()};
}

std::vector<std::string> labels_of(const Garment& garment) {
    std::set<std::string> labels;
    for (const BorderLine& b : garment.borders)
        if (!b.label.empty()) labels.insert(b.label);
    return {labels.begin(), labels.end()};
}

std::map<std::string, double> label_heights(const Garment& garment, const Points& x,
                                            const std::vector<std::string>& labels) {
    std::map<std::string, std::pair<double, int>> sum;
    for (const BorderLine& b : garment.borders) {
        if (std::find(labels.begin(), labels.end(), b.label) == labels.end()) continue;
        for (int v : b.vertices) {
            sum[b.label].first += x[garment.node_of_vertex[v]].y();
            ++sum[b.label].second;
        }
    }
    std::map<std::string, double> mean;
    for (const auto& [label, s] : sum)
        mean[label] = s.first / s.second;
    return mean;
}

double label_length(const Garment& garment, const std::string& label) {
    double sum = 0;
    for (const BorderLine& b : garment.borders)
        for (std::size_t k = 1; b.label == label && k < b.vertices.size(); ++k)
            sum += cut_length(garment, b.vertices[k - 1], b.vertices[k]);
    return sum;
}

std::vector<HookSpring> make_hooks(const Garment& garment, const std::map<std::string, double>& heights,
                                   double strength) {
    std::vector<HookSpring> springs;
    std::vector<char> hooked(garment.node_count, 0);
    for (const BorderLine& b : garment.borders) {
        const auto height = heights.find(b.label);
        if (height == heights.end()) continue;
        for (int v : b.vertices) {
            const int node = garment.node_of_vertex[v];
            if (hooked[node]) continue;
            hooked[node] = 1;
            HookSpring s;
            s.node = node;
            s.place = Vec3(0, height->second, 0);
            s.axes = Vec3::UnitY();
            springs.push_back(s);
        }
    }
    for (HookSpring& s : springs) {
        s.cap = strength / double(springs.size());
        s.stiffness = s.cap / give;
    }
    return springs;
}

double top_height(const Points& x) {
    double top = -std::numeric_limits<double>::infinity();
    for (const Vec3& p : x) top = std::max(top, p.y());
    return top;
}

double mean_height(const Points& x) {
    double sum = 0;
    for (const Vec3& p : x) sum += p.y();
    return sum / double(x.size());
}

} // namespace toile
