// long_test.h: what marks a test that is too long for the sanitizers.
#pragma once

// Before TEST: it takes the sanitizers five seconds and more, and shorter tests reach the same code, as where
// a browser shows what was written; the optimised build alone runs it (cmake/Tests.cmake).
#define TP_LONG
