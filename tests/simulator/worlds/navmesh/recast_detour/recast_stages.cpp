// Runs Recast's own library on triangles and writes what each stage answers.
//
// Standard input: 12 float32 (cell, cell height, slope in degrees, greatest error of an outline,
// distance of samples, greatest error of a height; then whole numbers: the robot's height, climb
// and radius in voxels, longest side in columns, least and mergeable spans of a region), int32
// numbers of vertices and triangles, vertices as float32, triangles as int32.
//
// Standard output: int32 arrays, each after its length; floats keep their bits.

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

#include <recastnavigation/Recast.h>

using Numbers = std::vector<int32_t>;

template <typename T> static std::vector<T> take(size_t count) {
  std::vector<T> values(count);
  if (fread(values.data(), sizeof(T), count, stdin) != count) throw 1;
  return values;
}

static void give(const Numbers& values) {
  const int32_t count = values.size();
  fwrite(&count, sizeof count, 1, stdout);
  fwrite(values.data(), sizeof(int32_t), values.size(), stdout);
}

template <typename T> static Numbers copied(const T* values, size_t count) {
  return Numbers(values, values + count);
}

// Column, lowest voxel, voxel above, and whether one can stand on it, of every span.
static Numbers spans_of(const rcHeightfield& solid) {
  Numbers rows;
  for (int column = 0; column < solid.width * solid.height; ++column)
    for (const rcSpan* s = solid.spans[column]; s; s = s->next)
      for (int value : {column, int(s->smin), int(s->smax), int(s->area != RC_NULL_AREA)})
        rows.push_back(value);
  return rows;
}

// Floor and the four neighbours of every span.
static Numbers links_of(const rcCompactHeightfield& space) {
  Numbers rows;
  for (int z = 0; z < space.height; ++z)
    for (int x = 0; x < space.width; ++x) {
      const rcCompactCell& cell = space.cells[x + z * space.width];
      for (unsigned i = cell.index; i < cell.index + cell.count; ++i) {
        rows.push_back(space.spans[i].y);
        for (int d = 0; d < 4; ++d) {
          const int con = rcGetCon(space.spans[i], d);
          const int nx = x + rcGetDirOffsetX(d), nz = z + rcGetDirOffsetY(d);
          rows.push_back(con == RC_NOT_CONNECTED
                             ? -1
                             : int(space.cells[nx + nz * space.width].index) + con);
        }
      }
    }
  return rows;
}

int main() {
  const auto s = take<float>(12);
  const auto counts = take<int32_t>(2);
  const auto vertices = take<float>(3 * counts[0]);
  const auto triangles = take<int32_t>(3 * counts[1]);
  const int height = s[6], climb = s[7], radius = s[8];
  rcContext context(false);
  float low[3], high[3];
  rcCalcBounds(vertices.data(), counts[0], low, high);
  int width, depth;
  rcCalcGridSize(low, high, s[0], &width, &depth);

  rcHeightfield& solid = *rcAllocHeightfield();
  rcCreateHeightfield(&context, solid, width, depth, low, high, s[0], s[1]);
  std::vector<unsigned char> areas(counts[1], RC_NULL_AREA);
  rcMarkWalkableTriangles(&context, s[2], vertices.data(), counts[0], triangles.data(), counts[1],
                          areas.data());
  give(copied(areas.data(), areas.size()));
  rcRasterizeTriangles(&context, vertices.data(), counts[0], triangles.data(), areas.data(),
                       counts[1], solid, climb);
  give({width, depth});
  give(spans_of(solid));
  rcFilterLowHangingWalkableObstacles(&context, climb, solid);
  give(spans_of(solid));
  rcFilterLedgeSpans(&context, height, climb, solid);
  give(spans_of(solid));
  // Up to 1.5.1 a room of just this height was too low; from 1.6.0 on it is enough.
  rcFilterWalkableLowHeightSpans(&context, height - 1, solid);
  give(spans_of(solid));

  rcCompactHeightfield& space = *rcAllocCompactHeightfield();
  rcBuildCompactHeightfield(&context, height, climb, solid, space);
  give(links_of(space));
  rcErodeWalkableArea(&context, radius, space);
  give(copied(space.areas, space.spanCount));
  rcBuildDistanceField(&context, space);
  give(copied(space.dist, space.spanCount));
  give({space.maxDistance});
  rcBuildRegions(&context, space, 0, int(s[10]), int(s[11]));
  Numbers regions;
  for (int i = 0; i < space.spanCount; ++i) regions.push_back(space.spans[i].reg);
  give(regions);

  rcContourSet& outlines = *rcAllocContourSet();
  rcBuildContours(&context, space, s[3], int(s[9]), outlines);
  Numbers corners, sizes;
  for (int i = 0; i < outlines.nconts; ++i) {
    const rcContour& outline = outlines.conts[i];
    sizes.insert(sizes.end(), {outline.nverts, outline.reg});
    corners.insert(corners.end(), outline.verts, outline.verts + 4 * outline.nverts);
  }
  give(sizes);
  give(corners);

  rcPolyMesh& mesh = *rcAllocPolyMesh();
  rcBuildPolyMesh(&context, outlines, 6, mesh);
  give(copied(mesh.verts, 3 * mesh.nverts));
  give(copied(mesh.polys, 12 * mesh.npolys));
  give(copied(mesh.regs, mesh.npolys));

  rcPolyMeshDetail& detail = *rcAllocPolyMeshDetail();
  rcBuildPolyMeshDetail(&context, mesh, space, s[4], s[5], detail);
  give(copied(detail.meshes, 4 * detail.nmeshes));
  Numbers bits(3 * detail.nverts);
  memcpy(bits.data(), detail.verts, bits.size() * sizeof(float));
  give(bits);
  give(copied(detail.tris, 4 * detail.ntris));
}
