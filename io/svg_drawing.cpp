// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/svg_drawing.h"

#include "geometry/text.h"
#include "io/markup.h"

namespace toile {

void SvgDrawing::line(double x0, double y0, double x1, double y1, const char* style) {
    body += text("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" %s/>\n", x0, y0, x1, y1, style);
}

void SvgDrawing::words(double x, double y, const char* anchor, const std::string& what, const char* more) {
    body += text("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" %s>", x, y, anchor, more) + escaped(what) + "</text>\n";
}

void SvgDrawing::words_upward(double x, double y, const std::string& what) {
    body += text("<text transform=\"translate(%g %.1f) rotate(-90)\" text-anchor=\"middle\">", x, y) + escaped(what) + "</text>\n";
}

void SvgDrawing::titled(const std::string& element, const std::string& title) {
    body += "<" + element + "><title>" + escaped(title) + "</title></" + element.substr(0, element.find(' ')) + ">\n";
}

std::string SvgDrawing::document(const std::string& title, double width, double height) const {
    return text("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %g %g\" width=\"%g\" height=\"%g\" font-family=\"sans-serif\" "
                "font-size=\"12\" role=\"img\">\n<title>",
                width, height, width, height) +
           escaped(title) + "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n" + body + "</svg>\n";
}

} // namespace toile
