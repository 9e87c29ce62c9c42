// metrics.h: how alike two pictures are: PSNR, SSIM and CIEDE2000.
//
// All take two pictures of the same size (ContractError otherwise) and a mask of that size, in which 0 leaves
// a pixel out; an empty mask counts every pixel. Masks that leave nothing are a ContractError. Sums do not
// depend on the number of threads.
#pragma once

#include <optional>
#include <span>

#include "surface/image/colour.h"
#include "surface/image/image.h"

namespace tangi {

using PixelMask = Image<unsigned char>;  // 0 = leave out; empty = everything counts

// The pixels that were measured: confidence > 0.
PixelMask measured(const Image<float>& confidence);

// [dB] 10 log10(1 / mean squared error) over all channels, both pictures clamped to [0, 1], peak 1.
// Symmetric. +infinity for equal pictures: reports cap it at kPsnrCap_db, since JSON knows no infinity.
double psnr_db(const Image<Rgb>& a, const Image<Rgb>& b, const PixelMask& mask = {});
constexpr double kPsnrCap_db = 100;

// [1] mean of b - a over all channels, both clamped to [0, 1]: > 0 where b is brighter.
double mean_difference(const Image<Rgb>& a, const Image<Rgb>& b, const PixelMask& mask = {});

// [1] luma of b minus luma of a, both clamped to [0, 1].
Image<float> luma_difference(const Image<Rgb>& a, const Image<Rgb>& b);
void luma_difference(std::span<const Rgb> a, std::span<const Rgb> b, std::span<float> difference);

// [1] structural similarity -1..1 of each pixel's neighbourhood, on luma (Rec. 709 weights on the values as
// they are). Wang, Bovik, Sheikh, Simoncelli 2004, eq. 13: Gaussian window of 11 x 11, sigma 1.5, K1 = 0.01,
// K2 = 0.03, L = 1. The window weighs only pixels that count and lie in the picture; without a mask and 5
// pixels away from the border that is the paper's. 0 where the mask leaves a pixel out.
Image<float> ssim_map(const Image<Rgb>& a, const Image<Rgb>& b, const PixelMask& mask = {});

// [1] mean of ssim_map over the pixels that count and whose window lies inside the picture, as in the
// authors' program; over all that count where there are none such.
double ssim(const Image<Rgb>& a, const Image<Rgb>& b, const PixelMask& mask = {});

// [1] Pearson's correlation of both lumas, -1..1: near 0 where the pictures have nothing but their brightness
// in common. Nothing where either hardly varies (standard deviation below 0.01), since then it tells nothing.
std::optional<double> luma_correlation(const Image<Rgb>& a, const Image<Rgb>& b, const PixelMask& mask = {});

// [1] CIEDE2000 of each pixel of two linear pictures, clamped to [0, 1], against the white D65.
Image<float> delta_e_2000_map(const Image<Rgb>& a_linear, const Image<Rgb>& b_linear);

double mean(const Image<float>& values, const PixelMask& mask = {});

// The value that `part` (0..1) of the values do not exceed: 0.5 is the median. Values that are not numbers
// are left out; nothing but those gives NaN.
double percentile(const Image<float>& values, double part, const PixelMask& mask = {});

}  // namespace tangi
