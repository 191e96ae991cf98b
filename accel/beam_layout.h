#pragma once

namespace raymeter {

inline constexpr int kBeamRays = 16;  ///< in a beam, at most

}  // namespace raymeter
