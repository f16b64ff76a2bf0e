#ifdef __x86_64__
#define ZENITH_PEER_SET EigenAvx512Update
#define ZENITH_PEER kUpdateAvx512
#define ZENITH_PEER_NAME "eigen-avx512"
#include "tests/bench/update_peer_eigen.h"
#endif
