// What this is compiled with, for the few who must know: a sanitizer reserves terabytes of address space, which no
// limit on memory allows, and that of threads also needs files to grow.
#pragma once

namespace granular {

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define GRANULAR_ADDRESS_SANITIZER 1
#endif
#if __has_feature(thread_sanitizer)
#define GRANULAR_THREAD_SANITIZER 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__)
#define GRANULAR_ADDRESS_SANITIZER 1
#endif
#if defined(__SANITIZE_THREAD__)
#define GRANULAR_THREAD_SANITIZER 1
#endif

#ifdef GRANULAR_THREAD_SANITIZER
inline constexpr bool threadSanitizer = true;
#else
inline constexpr bool threadSanitizer = false;
#endif
#ifdef GRANULAR_ADDRESS_SANITIZER
inline constexpr bool anySanitizer = true;
#else
inline constexpr bool anySanitizer = threadSanitizer;
#endif

}  // namespace granular
