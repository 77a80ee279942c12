#pragma once

#include <OpenImageIO/imageio.h>

namespace gltf
{

/* Keeps OpenImageIO and OpenEXR to the calling thread; any thread may call it. The attribute resizes a pool that OpenImageIO lets only one
 * thread resize (its thread.cpp): set for each picture, two encoders met there and an assertion of its own ended the program. */
inline void keep_oiio_to_one_thread()
{
    static const bool kept = OIIO::attribute("threads", 1) && OIIO::attribute("exr_threads", 1);
    (void)kept;
}

} // namespace gltf
