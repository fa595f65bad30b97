#pragma once

#include <string>

#include "lambake/report/chart_run.h"
#include "lambake/report/charts.h"

namespace lambake {

/// chart.json: all numbers of a run; infinite bounds are null.
std::string chart_json(const ChartRun& run);

/// chart.csv: one line per method and per frame, with a header line; RFC 4180.
std::string chart_csv(const ChartRun& run);

/// Time of a bake over its typical error (RMSE on the surface, on screen), per-pixel frames beside.
Chart speed_chart(const ChartRun& run);

/// Time of a bake over its largest error, certified; methods without a bound are left out.
Chart bound_chart(const ChartRun& run);

/// Time over the number of lights, per vertex and per pixel, with the place where they cost the same.
Chart lights_chart(const ChartRun& run);

/// Largest error over the number of vertices, with the slopes h and h².
Chart vertices_chart(const ChartRun& run);

/// index.html: the charts and the numbers, self-contained.
std::string chart_page(const ChartRun& run);

}  // namespace lambake
