#pragma once
// Small operations that have to be part of the code that uses them: a compiler that counts
// instructions before it optimises would call many of them.

#if defined(__GNUC__)
#define ANISOCONTACT_INLINE [[gnu::always_inline]] inline
#else
#define ANISOCONTACT_INLINE inline
#endif
