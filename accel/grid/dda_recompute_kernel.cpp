#include "accel/grid/dda_lanes_kernel.h"

namespace raymeter {

template struct GridLanesKernel<kKernelIsa, NoStats, DdaForm::recompute>;
template struct GridLanesKernel<kKernelIsa, CountStats, DdaForm::recompute>;

}  // namespace raymeter
