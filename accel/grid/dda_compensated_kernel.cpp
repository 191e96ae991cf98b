#include "accel/grid/dda_lanes_kernel.h"

namespace raymeter {

template struct GridLanesKernel<kKernelIsa, NoStats, DdaForm::compensated>;
template struct GridLanesKernel<kKernelIsa, CountStats, DdaForm::compensated>;

}  // namespace raymeter
