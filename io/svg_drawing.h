// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace toile {

/// Lines and words of a diagram in SVG, in pixels from the upper left.
class SvgDrawing {
public:
    std::string body; ///< elements so far

    void line(double x0, double y0, double x1, double y1, const char* style);
    /// `anchor` is start, middle or end, `more` further attributes.
    void words(double x, double y, const char* anchor, const std::string& what, const char* more = "");
    /// Of a vertical axis, read upwards, with its middle there.
    void words_upward(double x, double y, const std::string& what);
    /// An element with what is said where the pointer rests on it; `element` is "circle ...".
    void titled(const std::string& element, const std::string& title);

    /// The whole picture on white.
    std::string document(const std::string& title, double width, double height) const;
};

} // namespace toile
