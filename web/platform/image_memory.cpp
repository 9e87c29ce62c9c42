// image_memory.cpp: pixels of the web engine, which has no disk to put them aside on.
#include "surface/image/image_memory.h"

namespace tangi {

void limit_image_memory(std::size_t) {}
bool images_go_to_disk(double) { return false; }
void* take_image_memory(std::size_t bytes) { return ::operator new(bytes); }
void give_image_memory(void* data, std::size_t) noexcept { ::operator delete(data); }

}  // namespace tangi
