/* Powers of ten in 128 bits, for the conversion between decimal text and binary numbers. */
#include "io/stream_private.h"

/* The 128 leading bits of a power of ten, cut off behind. Its exponent follows from power_exponent(). */
struct bits {
    uint64_t high, low;
};

/* 10^0 ... 10^27, exact. */
static const struct bits fine[] = {
    {0x8000000000000000, 0x0000000000000000}, /* 1e0 */
    {0xa000000000000000, 0x0000000000000000}, /* 1e1 */
    {0xc800000000000000, 0x0000000000000000}, /* 1e2 */
    {0xfa00000000000000, 0x0000000000000000}, /* 1e3 */
    {0x9c40000000000000, 0x0000000000000000}, /* 1e4 */
    {0xc350000000000000, 0x0000000000000000}, /* 1e5 */
    {0xf424000000000000, 0x0000000000000000}, /* 1e6 */
    {0x9896800000000000, 0x0000000000000000}, /* 1e7 */
    {0xbebc200000000000, 0x0000000000000000}, /* 1e8 */
    {0xee6b280000000000, 0x0000000000000000}, /* 1e9 */
    {0x9502f90000000000, 0x0000000000000000}, /* 1e10 */
    {0xba43b74000000000, 0x0000000000000000}, /* 1e11 */
    {0xe8d4a51000000000, 0x0000000000000000}, /* 1e12 */
    {0x9184e72a00000000, 0x0000000000000000}, /* 1e13 */
    {0xb5e620f480000000, 0x0000000000000000}, /* 1e14 */
    {0xe35fa931a0000000, 0x0000000000000000}, /* 1e15 */
    {0x8e1bc9bf04000000, 0x0000000000000000}, /* 1e16 */
    {0xb1a2bc2ec5000000, 0x0000000000000000}, /* 1e17 */
    {0xde0b6b3a76400000, 0x0000000000000000}, /* 1e18 */
    {0x8ac7230489e80000, 0x0000000000000000}, /* 1e19 */
    {0xad78ebc5ac620000, 0x0000000000000000}, /* 1e20 */
    {0xd8d726b7177a8000, 0x0000000000000000}, /* 1e21 */
    {0x878678326eac9000, 0x0000000000000000}, /* 1e22 */
    {0xa968163f0a57b400, 0x0000000000000000}, /* 1e23 */
    {0xd3c21bcecceda100, 0x0000000000000000}, /* 1e24 */
    {0x84595161401484a0, 0x0000000000000000}, /* 1e25 */
    {0xa56fa5b99019a5c8, 0x0000000000000000}, /* 1e26 */
    {0xcecb8f27f4200f3a, 0x0000000000000000}, /* 1e27 */
};

/* 10^(28 j), j = -13 ... 12. */
enum { STEP = 28, FIRST = -13 };
static const struct bits coarse[] = {
    {0xe1afa13afbd14d6d, 0x82189c09a3a1ec21}, /* 1e-364 */
    {0xe3e27a444d8d98b7, 0xfd1b1b2308169b25}, /* 1e-336 */
    {0xe61acf033d1a45df, 0x6fb92487298e33bd}, /* 1e-308 */
    {0xe858ad248f5c22c9, 0xd1b3400f8f9cff68}, /* 1e-280 */
    {0xea9c227723ee8bcb, 0x465e15a979c1cadc}, /* 1e-252 */
    {0xece53cec4a314ebd, 0xa4f8bf5635246428}, /* 1e-224 */
    {0xef340a98172aace4, 0x86fb897116c87c34}, /* 1e-196 */
    {0xf18899b1bc3f8ca1, 0xdc44e6c3cb279ac1}, /* 1e-168 */
    {0xf3e2f893dec3f126, 0x5a89dba3c3efccfa}, /* 1e-140 */
    {0xf64335bcf065d37d, 0x4d4617b5ff4a16d5}, /* 1e-112 */
    {0xf8a95fcf88747d94, 0x75a44c6397ce912a}, /* 1e-84 */
    {0xfb158592be068d2e, 0xeed6e2f0f0d56712}, /* 1e-56 */
    {0xfd87b5f28300ca0d, 0x8bca9d6e188853fc}, /* 1e-28 */
    {0x8000000000000000, 0x0000000000000000}, /* 1e0 */
    {0x813f3978f8940984, 0x4000000000000000}, /* 1e28 */
    {0x82818f1281ed449f, 0xbff8f10e7a8921a4}, /* 1e56 */
    {0x83c7088e1aab65db, 0x792667c6da79e0fa}, /* 1e84 */
    {0x850fadc09923329e, 0x03e2cf6bc604ddb0}, /* 1e112 */
    {0x865b86925b9bc5c2, 0x0b8a2392ba45a9b2}, /* 1e140 */
    {0x87aa9aff79042286, 0x90fb44d2f05d0842}, /* 1e168 */
    {0x88fcf317f22241e2, 0x441fece3bdf81f03}, /* 1e196 */
    {0x8a5296ffe33cc92f, 0x82bd6b70d99aaa6f}, /* 1e224 */
    {0x8bab8eefb6409c1a, 0x1ad089b6c2f7548e}, /* 1e252 */
    {0x8d07e33455637eb2, 0xdb0b487b6423e1e8}, /* 1e280 */
    {0x8e679c2f5e44ff8f, 0x570f09eaa7ea7648}, /* 1e308 */
    {0x8fcac257558ee4e6, 0x213a4f0aa5e8a7b1}, /* 1e336 */
};

__extension__ typedef unsigned __int128 uint128;

static uint128 join(struct bits bits)
{
    return (uint128)bits.high << 64 | bits.low;
}

/* The upper half of the product of two 128-bit numbers, or one less. */
static uint128 multiply_high(struct bits a, struct bits b)
{
    uint128 high_low = (uint128)a.high * b.low;
    uint128 low_high = (uint128)a.low * b.high;
    uint128 low = (uint128)a.low * b.low;
    uint128 middle = (uint128)(uint64_t)high_low + (uint64_t)low_high + (uint64_t)(low >> 64);
    return (uint128)a.high * b.high + (high_low >> 64) + (low_high >> 64) + (middle >> 64);
}

int power_exponent(int power)
{
    /* floor(power * log2(10)), exact for |power| < 1650 */
    return (int)(((int64_t)power * 217706) >> 16) - 127;
}

void power_of_ten(int power, uint64_t *high, uint64_t *low)
{
    int step = (power >= 0 ? power : power - STEP + 1) / STEP;
    struct bits f = fine[power - step * STEP];
    uint128 product = join(f);
    if (step != 0) {
        product = multiply_high(f, coarse[step - FIRST]);
        if (product >> 127 == 0) {
            product <<= 1;
        }
    }
    *high = (uint64_t)(product >> 64);
    *low = (uint64_t)product;
}
