#pragma once

/// \file EXTREMAL_ADDRESS_SANITIZER: 1 in a build with the address sanitizer, which has a malloc of its own.

#if defined(__SANITIZE_ADDRESS__)  // GCC's
#define EXTREMAL_ADDRESS_SANITIZER 1
#elif defined(__has_feature)  // clang's
#if __has_feature(address_sanitizer)
#define EXTREMAL_ADDRESS_SANITIZER 1
#endif
#endif
#ifndef EXTREMAL_ADDRESS_SANITIZER
#define EXTREMAL_ADDRESS_SANITIZER 0
#endif
