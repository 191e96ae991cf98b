#include "accel/grid/dda_lanes_kernel.h"

namespace raymeter {

template struct GridLanesKernel<kKernelIsa, NoStats, DdaForm::accumulate>;
template struct GridLanesKernel<kKernelIsa, CountStats, DdaForm::accumulate>;

}  // namespace raymeter
