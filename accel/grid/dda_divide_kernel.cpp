#include "accel/grid/dda_lanes_kernel.h"

namespace raymeter {

template struct GridLanesKernel<kKernelIsa, NoStats, DdaForm::divide>;
template struct GridLanesKernel<kKernelIsa, CountStats, DdaForm::divide>;

}  // namespace raymeter
