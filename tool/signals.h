#pragma once

namespace lambake::tool {

/// From now on a signal that ends the program (Ctrl-C, kill, a closed terminal) removes first what is half
/// written, and a closed pipe is an error of writing. To be called before there are threads.
void prepare_for_signals();

}  // namespace lambake::tool
