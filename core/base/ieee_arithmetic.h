#pragma once

namespace raymeter {

/// For its lifetime the calling thread rounds to nearest, keeps denormal numbers (neither FTZ nor DAZ) and traps on nothing, as the kernels' proofs take for
/// granted, whatever the program around has set; then all is as it was, flags of exceptions included.
class IeeeArithmetic {
public:
  IeeeArithmetic() noexcept : callers_(__builtin_ia32_stmxcsr()) { __builtin_ia32_ldmxcsr(kAllMasked); }
  ~IeeeArithmetic() { __builtin_ia32_ldmxcsr(callers_); }
  IeeeArithmetic(const IeeeArithmetic&) = delete;
  IeeeArithmetic& operator=(const IeeeArithmetic&) = delete;

private:
  static constexpr unsigned kAllMasked = 0x1F80;  // MXCSR as a process begins with

  unsigned callers_;
};

}  // namespace raymeter
