#include "lambake/io/color_storage.h"

namespace lambake {

void tell_storage(Findings& findings, std::size_t clipped, std::size_t negative) {
  add_finding(findings, "clipped_vertices", clipped,
              "vert[ex is|ices are] brighter than a vertex colour can hold; clipped to 1 (a lower exposure "
              "avoids it)");
  add_finding(findings, "negative_vertices", negative,
              "vert[ex has|ices have] a colour below 0; stored as 0");
}

}  // namespace lambake
