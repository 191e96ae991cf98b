#include "accel/grid/dda_lanes_kernel.h"

namespace raymeter {

template struct GridLanesKernel<kKernelIsa, NoStats, DdaForm::fma>;
template struct GridLanesKernel<kKernelIsa, CountStats, DdaForm::fma>;

}  // namespace raymeter
