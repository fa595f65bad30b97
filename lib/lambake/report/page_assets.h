#pragma once

#include <string_view>

/// The files of report/page/, embedded when lambake is built (page/embed.cmake). Internal to the folder.
namespace lambake::page_assets {

extern const std::string_view page_html;  ///< The frame, with {{slots}}.
extern const std::string_view page_css;
extern const std::string_view chart_css;  ///< Of the charts in the page and of those in files.
extern const std::string_view page_js;

}  // namespace lambake::page_assets
