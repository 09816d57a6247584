// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/chart_page.h"

#include "geometry/text.h"
#include "io/chart_svg.h"
#include "io/markup.h"

namespace toile {

namespace {

std::string seconds(double s) { return text(s < 0.1 ? "%.4f" : "%.3g", s); }

std::string fastest_cell(const ChartPoint* p) {
    if (!p) return "<td class=\"words\">none</td>";
    return text("<td class=\"words\">%s, %.3g mm, %s s</td>", to_string(p->method), 1e3 * p->edge_length, seconds(p->seconds_cpu).c_str());
}

std::string row(const ChartPoint& p) {
    return text("<tr><td>%s</td><td>%.3g</td><td>%s</td><td>%.3g</td><td>%s</td><td>%s</td><td>%s</td>", to_string(p.method), 1e3 * p.edge_length,
                p.step > 0 ? text("%.3g", 1e3 * p.step).c_str() : "", 100 * p.error,
                p.error_solver ? text("%.2g", 100 * *p.error_solver).c_str() : "", seconds(p.seconds_cpu).c_str(),
                seconds(p.seconds_wall).c_str()) +
           (p.failure.empty() ? "<td class=\"words\">converged</td></tr>\n"
                              : "<td class=\"words fails\">" + escaped(p.failure) + "</td></tr>\n");
}

} // namespace

std::string chart_page(const Chart& chart, const ChartMachine& machine) {
    std::string page = "<p>" + escaped(machine.version) + " on " + escaped(machine.processor) +
                       text(", %d threads; ", machine.threads) + escaped(machine.blas) +
                       ". Times are medians: processor time on one thread, wall time on all.</p>\n";
    page += "<table>\n<tr><th>scene</th>";
    for (const double error : marked_errors) page += text("<th>fastest within %g %%</th>", 100 * error);
    page += "</tr>\n";
    for (const ChartScene& s : chart.scenes) {
        page += "<tr><td>" + escaped(s.scene.name) + "</td>";
        for (const double error : marked_errors) page += fastest_cell(fastest_within(chart, s.scene.name, error));
        page += "</tr>\n";
    }
    page += "</table>\n";
    for (const ChartScene& s : chart.scenes) {
        page += "<section>\n" + chart_svg(chart, s) +
                "<details><summary>Every point</summary>\n<table>\n<tr><th>method</th><th>edge mm</th><th>step ms</th><th>error %</th>"
                "<th>by the solver %</th><th>CPU s</th><th>wall s</th><th>status</th></tr>\n";
        for (const ChartPoint& p : chart.points)
            if (p.scene == s.scene.name) page += row(p);
        page += "</table>\n</details>\n</section>\n";
    }
    return html_page("Error against time", page);
}

} // namespace toile
