// Written by imu_calibrate 0.1.0 from tests/golden/turning_unit.yaml,
// SHA-256 c801f1f1da99fb3ace694b9bc7e29e18a962196ab2037fecba9869265ae3ad45. Do not edit.
// Unit: TURNING-16 golden
#pragma once
// clang-format off

#include "trunnion/error_model/count_correction.hpp"
#include "trunnion/error_model/inertial_unit.hpp"

namespace golden {

// For raw counts: rate [rad/s] = (count - 0) / 938.73000000000002, specific force [m/s^2] = (count - 0) / 208.83000000000001.
inline constexpr trunnion::UnitCorrection<float>::Coefficients kUnit = {
    {{{0x1.3a33b6p-8F, -0x1.61c748p-18F, -0x1.819a56p-17F}, {0x1.314dcp-17F, 0x1.394a8ep-8F, -0x1.01e1aep-18F}, {-0x1.a1860ap-18F, 0x1.818b8cp-19F, 0x1.398b14p-8F}},
     {-0x1.85ae3ep-4F, 0x1.2c451ap-3F, -0x1.d8f9fcp-5F},
     {-0x1.4503b6p-12F, 0x1.8cfbep-13F, -0x1.0fd7eep-12F},
     {0x1.43bd64p-20F, -0x1.265fc8p-19F, -0x1.e44bd2p-21F}},
    {{{0x1.16aa68p-10F, -0x1.f3bd8p-19F, 0x1.57d93p-20F}, {0x1.904feap-19F, 0x1.17ab6cp-10F, -0x1.e57fecp-20F}, {-0x1.fdb4bep-21F, 0x1.3b37aap-19F, 0x1.170782p-10F}},
     {-0x1.d1caaap-8F, 0x1.5ae942p-8F, -0x1.a0bb7p-9F},
     {-0x1.948ce2p-17F, 0x1.607b54p-16F, -0x1.d18f4p-18F},
     {-0x1.408f3ap-23F, -0x1.5ab6fcp-24F, 0x1.d7e214p-24F}},
    {{0x1.6fe384p-17F, -0x1.0d7f34p-18F, 0x1.1079ap-19F}, {0x1.97d78ep-19F, 0x1.2db8ccp-17F, -0x1.51436p-18F}, {-0x1.0ca5cep-19F, 0x1.93e672p-18F, 0x1.d4f46p-17F}},
    {{{0x1.004ecep+0F, -0x1.20978ep-10F, -0x1.3a8d72p-9F}, {0x1.f21926p-10F, 0x1.ff2138p-1F, -0x1.a4bacep-11F}, {-0x1.549772p-10F, 0x1.3a8162p-11F, 0x1.ff8a7cp-1F}},
     {0x0p+0F, 0x0p+0F, 0x0p+0F}, {0x0p+0F, 0x0p+0F, 0x0p+0F}, {0x0p+0F, 0x0p+0F, 0x0p+0F}},
    {{{0x1.feebe8p-1F, -0x1.ca204ap-9F, 0x1.3b3734p-10F}, {0x1.6efa42p-9F, 0x1.00619p+0F, -0x1.bd124ap-10F}, {-0x1.d34316p-11F, 0x1.20f804p-9F, 0x1.ff9698p-1F}},
     {0x0p+0F, 0x0p+0F, 0x0p+0F}, {0x0p+0F, 0x0p+0F, 0x0p+0F}, {0x0p+0F, 0x0p+0F, 0x0p+0F}},
    0x1.9p+4F, 0x1p+0F};

// Readings of 16 bits in, corrected counts of 1/64 out: SI = out / kGyroScale, out / kAccelScale.
// Largest error against exact arithmetic, in counts out: gyros 0.629, accelerometers 0.628.
inline constexpr double kGyroScale = 60078.720000000001;   // counts out per rad/s
inline constexpr double kAccelScale = 13365.120000000001;  // counts out per m/s^2
inline constexpr trunnion::CountCoefficients kCounts = {
    {{{-1831822889762LL, -12152433LL, -588LL,
      {1071480046, -3752969, 1291123}, {-211677, 77532, -39194}, 0, 0},
     {1368047432127LL, 21176652LL, -318LL,
      {3006280, 1075340302, -1823013}, {-58666, -173606, 97028}, 0, 0},
     {-818256280392LL, -6992556LL, 433LL,
      {-956953, 2367233, 1072878349}, {38644, -116199, -269829}, 0, 0}}},
    {{{-5458971065987LL, -69501723LL, 1056LL,
      {1075032967, -1182073, -2576814}, {0, 0, 0}, 0, 0},
     {8418319983483LL, 42445900LL, -1921LL,
      {2040210, 1071916804, -861654}, {0, 0, 0}, 0, 0},
     {-3312080245594LL, -58131533LL, -790LL,
      {-1395063, 644107, 1072779156}, {0, 0, 0}, 0, 0}}},
    6400, 16, 8, 1, 0};

}  // namespace golden
