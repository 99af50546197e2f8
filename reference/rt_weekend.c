/*
 * The path tracer of "Ray Tracing in One Weekend" v4.0.2 in plain C89: one thread, one ray at a time, doubles, the
 * book's arithmetic. It is the control that Weekender's speed is compared with, and its picture is the same but for
 * noise.
 *
 *   cc -std=c89 -pedantic -Wall -Wextra -O2 -o rt_weekend rt_weekend.c -lm
 *   ./rt_weekend WIDTH HEIGHT SAMPLES DEPTH SEED [--scene FILE] [--out FILE.ppm|FILE.pfm]
 *
 * Without --scene it renders the three spheres. A scene file has one thing a line:
 *
 *   camera      FROM FROM FROM  AT AT AT  UP UP UP  VFOV DEFOCUS FOCUS
 *   sky         BOTTOM BOTTOM BOTTOM  TOP TOP TOP
 *   lambertian  CENTER CENTER CENTER RADIUS  RED GREEN BLUE
 *   metal       CENTER CENTER CENTER RADIUS  RED GREEN BLUE FUZZ
 *   dielectric  CENTER CENTER CENTER RADIUS  INDEX
 *
 * It prints "tracing" when it begins to trace and then "trace_seconds S paths P rays R". S is processor time of the
 * tracing alone: reading the scene and writing the picture are not in it. C89 has no clock of wall time that is fine
 * enough; whoever wants it measures from one line to the other. A .ppm file is the picture as it is shown; a .pfm file has the linear means.
 */

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define PI 3.14159265358979323846
#define T_MIN 0.001

/* ---- Vectors ---- */

typedef struct {
    double x, y, z;
} Vec3;

typedef struct {
    Vec3 origin, direction;
} Ray;

static Vec3 vec3(double x, double y, double z)
{
    Vec3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}

static Vec3 add(Vec3 a, Vec3 b) { return vec3(a.x + b.x, a.y + b.y, a.z + b.z); }
static Vec3 sub(Vec3 a, Vec3 b) { return vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
static Vec3 mul(Vec3 a, Vec3 b) { return vec3(a.x * b.x, a.y * b.y, a.z * b.z); }
static Vec3 scale(double s, Vec3 a) { return vec3(s * a.x, s * a.y, s * a.z); }
static double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static Vec3 unit(Vec3 a) { return scale(1.0 / sqrt(dot(a, a)), a); }

static Vec3 cross(Vec3 a, Vec3 b)
{
    return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

/* ---- Random numbers: xorshift of 128 bits (Marsaglia 2003) ---- */

typedef struct {
    unsigned int x, y, z, w;
} Random;

static unsigned int next_random(Random *random)
{
    unsigned int t = random->x ^ (random->x << 11);
    random->x = random->y;
    random->y = random->z;
    random->z = random->w;
    random->w = random->w ^ (random->w >> 19) ^ t ^ (t >> 8);
    return random->w;
}

static void seed_random(Random *random, unsigned int seed)
{
    int i;
    random->x = 123456789u ^ seed;
    random->y = 362436069u + seed * 2654435769u;
    random->z = 521288629u;
    random->w = 88675123u;
    for (i = 0; i < 64; i++)
        next_random(random);
}

/* In [0, 1). */
static double random_unit(Random *random) { return (next_random(random) >> 8) * (1.0 / 16777216.0); }

static double random_signed(Random *random) { return 2.0 * random_unit(random) - 1.0; }

static Vec3 random_unit_vector(Random *random)
{
    for (;;) {
        double x = random_signed(random);
        double y = random_signed(random);
        double z = random_signed(random);
        double length2 = x * x + y * y + z * z;
        if (1e-160 < length2 && length2 <= 1.0)
            return scale(1.0 / sqrt(length2), vec3(x, y, z));
    }
}

static Vec3 random_in_unit_disk(Random *random)
{
    for (;;) {
        double x = random_signed(random);
        double y = random_signed(random);
        if (x * x + y * y < 1.0)
            return vec3(x, y, 0.0);
    }
}

/* ---- Scenes ---- */

typedef enum { LAMBERTIAN, METAL, DIELECTRIC } MaterialKind;

typedef struct {
    Vec3 center;
    double radius;
    MaterialKind kind;
    Vec3 albedo;
    double fuzz_or_index;
} Sphere;

typedef struct {
    Vec3 look_from, look_at, vup;
    double vfov_degrees, defocus_degrees, focus_distance;
} Camera;

typedef struct {
    Sphere *spheres;
    size_t count, room;
    Vec3 sky_bottom, sky_top;
    Camera camera;
} Scene;

static void fail(const char *message, const char *detail)
{
    fprintf(stderr, "rt_weekend: %s%s\n", message, detail);
    exit(2);
}

static void add_sphere(Scene *scene, Vec3 center, double radius, MaterialKind kind, Vec3 albedo, double fuzz_or_index)
{
    Sphere *sphere;
    if (scene->count == scene->room) {
        scene->room = scene->room > 0 ? 2 * scene->room : 64;
        scene->spheres = (Sphere *)realloc(scene->spheres, scene->room * sizeof *scene->spheres);
        if (scene->spheres == NULL)
            fail("out of memory", "");
    }
    sphere = &scene->spheres[scene->count++];
    sphere->center = center;
    sphere->radius = radius;
    sphere->kind = kind;
    sphere->albedo = albedo;
    sphere->fuzz_or_index = kind == METAL && fuzz_or_index > 1.0 ? 1.0 : fuzz_or_index;
}

static void empty_scene(Scene *scene)
{
    scene->spheres = NULL;
    scene->count = scene->room = 0;
    scene->sky_bottom = vec3(1.0, 1.0, 1.0);
    scene->sky_top = vec3(0.5, 0.7, 1.0);
    scene->camera.look_from = vec3(0.0, 0.0, 0.0);
    scene->camera.look_at = vec3(0.0, 0.0, -1.0);
    scene->camera.vup = vec3(0.0, 1.0, 0.0);
    scene->camera.vfov_degrees = 90.0;
    scene->camera.defocus_degrees = 0.0;
    scene->camera.focus_distance = 1.0;
}

static void three_spheres(Scene *scene)
{
    Vec3 white = vec3(1.0, 1.0, 1.0);
    empty_scene(scene);
    add_sphere(scene, vec3(0.0, -100.5, -1.0), 100.0, LAMBERTIAN, vec3(0.8, 0.8, 0.0), 0.0);
    add_sphere(scene, vec3(0.0, 0.0, -1.2), 0.5, LAMBERTIAN, vec3(0.1, 0.2, 0.5), 0.0);
    add_sphere(scene, vec3(-1.0, 0.0, -1.0), 0.5, DIELECTRIC, white, 1.5);
    add_sphere(scene, vec3(-1.0, 0.0, -1.0), 0.4, DIELECTRIC, white, 1.0 / 1.5);
    add_sphere(scene, vec3(1.0, 0.0, -1.0), 0.5, METAL, vec3(0.8, 0.6, 0.2), 1.0);
}

static void read_numbers(FILE *file, const char *word, double *numbers, int count)
{
    int i;
    for (i = 0; i < count; i++)
        if (fscanf(file, "%lf", &numbers[i]) != 1)
            fail("too few numbers after ", word);
}

static void read_scene(Scene *scene, const char *path)
{
    char word[16];
    double n[12];
    FILE *file = fopen(path, "r");
    if (file == NULL)
        fail("cannot read ", path);
    empty_scene(scene);
    while (fscanf(file, "%15s", word) == 1) {
        if (strcmp(word, "camera") == 0) {
            read_numbers(file, word, n, 12);
            scene->camera.look_from = vec3(n[0], n[1], n[2]);
            scene->camera.look_at = vec3(n[3], n[4], n[5]);
            scene->camera.vup = vec3(n[6], n[7], n[8]);
            scene->camera.vfov_degrees = n[9];
            scene->camera.defocus_degrees = n[10];
            scene->camera.focus_distance = n[11];
        } else if (strcmp(word, "sky") == 0) {
            read_numbers(file, word, n, 6);
            scene->sky_bottom = vec3(n[0], n[1], n[2]);
            scene->sky_top = vec3(n[3], n[4], n[5]);
        } else if (strcmp(word, "lambertian") == 0) {
            read_numbers(file, word, n, 7);
            add_sphere(scene, vec3(n[0], n[1], n[2]), n[3], LAMBERTIAN, vec3(n[4], n[5], n[6]), 0.0);
        } else if (strcmp(word, "metal") == 0) {
            read_numbers(file, word, n, 8);
            add_sphere(scene, vec3(n[0], n[1], n[2]), n[3], METAL, vec3(n[4], n[5], n[6]), n[7]);
        } else if (strcmp(word, "dielectric") == 0) {
            read_numbers(file, word, n, 5);
            add_sphere(scene, vec3(n[0], n[1], n[2]), n[3], DIELECTRIC, vec3(1.0, 1.0, 1.0), n[4]);
        } else {
            fail("the scene has an unknown word: ", word);
        }
    }
    fclose(file);
}

/* ---- Tracing ---- */

/* The nearest sphere beyond T_MIN, or NULL. */
static const Sphere *nearest_hit(const Scene *scene, const Ray *ray, double *nearest)
{
    const Sphere *found = NULL;
    double a = dot(ray->direction, ray->direction);
    size_t i;
    *nearest = HUGE_VAL;
    for (i = 0; i < scene->count; i++) {
        const Sphere *sphere = &scene->spheres[i];
        Vec3 to_center = sub(sphere->center, ray->origin);
        double h = dot(ray->direction, to_center);
        double c = dot(to_center, to_center) - sphere->radius * sphere->radius;
        double discriminant = h * h - a * c;
        double root, t;
        if (discriminant < 0.0)
            continue;
        root = sqrt(discriminant);
        t = (h - root) / a;
        if (t <= T_MIN || *nearest <= t) {
            t = (h + root) / a;
            if (t <= T_MIN || *nearest <= t)
                continue;
        }
        *nearest = t;
        found = sphere;
    }
    return found;
}

static Vec3 reflect(Vec3 v, Vec3 normal) { return sub(v, scale(2.0 * dot(v, normal), normal)); }

static Vec3 refract(Vec3 v, Vec3 normal, double cosine, double ratio)
{
    Vec3 across = scale(ratio, add(v, scale(cosine, normal)));
    return sub(across, scale(sqrt(fabs(1.0 - dot(across, across))), normal));
}

/* Schlick's approximation. */
static double reflectance(double cosine, double ratio)
{
    double r0 = (1.0 - ratio) / (1.0 + ratio);
    double x = 1.0 - cosine;
    r0 = r0 * r0;
    return r0 + (1.0 - r0) * x * x * x * x * x;
}

/* Sends the ray on from point. Returns 0 if it is absorbed. */
static int scatter(const Sphere *sphere, Vec3 point, Ray *ray, Random *random)
{
    Vec3 outward = scale(1.0 / sphere->radius, sub(point, sphere->center));
    int is_front = dot(ray->direction, outward) < 0.0;
    Vec3 normal = is_front ? outward : scale(-1.0, outward);
    Vec3 direction;

    ray->origin = point;
    if (sphere->kind == LAMBERTIAN) {
        direction = add(normal, random_unit_vector(random));
        if (fabs(direction.x) < 1e-8 && fabs(direction.y) < 1e-8 && fabs(direction.z) < 1e-8)
            direction = normal;
        ray->direction = direction;
        return 1;
    }
    if (sphere->kind == METAL) {
        direction = unit(reflect(ray->direction, normal));
        ray->direction = add(direction, scale(sphere->fuzz_or_index, random_unit_vector(random)));
        return dot(ray->direction, normal) > 0.0;
    } else {
        double index = sphere->fuzz_or_index;
        double ratio = is_front ? 1.0 / index : index;
        double cosine, sine;
        direction = unit(ray->direction);
        cosine = -dot(direction, normal);
        if (cosine > 1.0)
            cosine = 1.0;
        sine = sqrt(1.0 - cosine * cosine);
        if (ratio * sine > 1.0 || reflectance(cosine, ratio) > random_unit(random))
            ray->direction = reflect(direction, normal);
        else
            ray->direction = refract(direction, normal, cosine, ratio);
        return 1;
    }
}

/* The light that arrives along a ray. Adds the rays that it took to *rays. */
static Vec3 ray_color(const Scene *scene, Ray ray, int depth, Random *random, double *rays)
{
    Vec3 attenuation = vec3(1.0, 1.0, 1.0);
    int bounce;
    for (bounce = 0; bounce < depth; bounce++) {
        double t;
        const Sphere *sphere = nearest_hit(scene, &ray, &t);
        if (sphere == NULL) {
            double share = 0.5 * (unit(ray.direction).y + 1.0);
            Vec3 sky = add(scale(1.0 - share, scene->sky_bottom), scale(share, scene->sky_top));
            *rays += bounce + 1;
            return mul(attenuation, sky);
        }
        if (!scatter(sphere, add(ray.origin, scale(t, ray.direction)), &ray, random)) {
            *rays += bounce + 1;
            return vec3(0.0, 0.0, 0.0);
        }
        attenuation = mul(attenuation, sphere->albedo);
    }
    *rays += depth;
    return vec3(0.0, 0.0, 0.0);
}

/* Fills the linear means of width * height pixels, RGB, from the upper left. Returns how many rays it took. */
static double render(const Scene *scene, int width, int height, long samples, int depth, unsigned int seed, float *means)
{
    const Camera *camera = &scene->camera;
    double focus = camera->focus_distance;
    double viewport_height = 2.0 * tan(camera->vfov_degrees * PI / 360.0) * focus;
    double viewport_width = viewport_height * width / height;
    double lens_radius = focus * tan(camera->defocus_degrees * PI / 360.0);
    Vec3 w = unit(sub(camera->look_from, camera->look_at));
    Vec3 u = unit(cross(camera->vup, w));
    Vec3 v = cross(w, u);
    Vec3 step_x = scale(viewport_width / width, u);
    Vec3 step_y = scale(-viewport_height / height, v);
    Vec3 corner = add(sub(camera->look_from, scale(focus, w)),
                      add(scale(-0.5 * viewport_width, u), scale(0.5 * viewport_height, v)));
    Random random;
    double rays = 0.0;
    int x, y;
    long sample;

    seed_random(&random, seed);
    for (y = 0; y < height; y++) {
        for (x = 0; x < width; x++) {
            Vec3 sum = vec3(0.0, 0.0, 0.0);
            for (sample = 0; sample < samples; sample++) {
                double sx = x + random_unit(&random);
                double sy = y + random_unit(&random);
                Vec3 target = add(corner, add(scale(sx, step_x), scale(sy, step_y)));
                Ray ray;
                ray.origin = camera->look_from;
                if (lens_radius > 0.0) {
                    Vec3 p = random_in_unit_disk(&random);
                    ray.origin = add(ray.origin, scale(lens_radius, add(scale(p.x, u), scale(p.y, v))));
                }
                ray.direction = sub(target, ray.origin);
                sum = add(sum, ray_color(scene, ray, depth, &random, &rays));
            }
            *means++ = (float)(sum.x / samples);
            *means++ = (float)(sum.y / samples);
            *means++ = (float)(sum.z / samples);
        }
    }
    return rays;
}

/* ---- Output ---- */

static int to_byte(double linear)
{
    double shown = linear > 0.0 ? sqrt(linear) : 0.0;
    return (int)(256.0 * (shown < 0.999 ? shown : 0.999));
}

static void write_ppm(FILE *file, const float *means, int width, int height)
{
    long i;
    fprintf(file, "P6\n%d %d\n255\n", width, height);
    for (i = 0; i < 3L * width * height; i++)
        putc(to_byte(means[i]), file);
}

/* Rows from the bottom up; the sign of the scale says how the machine orders bytes. */
static void write_pfm(FILE *file, const float *means, int width, int height)
{
    const int one = 1;
    int y;
    fprintf(file, "PF\n%d %d\n%s\n", width, height, *(const char *)&one == 1 ? "-1.0" : "1.0");
    for (y = height - 1; y >= 0; y--)
        fwrite(means + 3L * width * y, sizeof *means, 3 * (size_t)width, file);
}

static void write_picture(const char *path, const float *means, int width, int height)
{
    size_t length = strlen(path);
    FILE *file = fopen(path, "wb");
    if (file == NULL)
        fail("cannot write ", path);
    if (length > 4 && strcmp(path + length - 4, ".pfm") == 0)
        write_pfm(file, means, width, height);
    else
        write_ppm(file, means, width, height);
    if (ferror(file) | fclose(file))
        fail("cannot write ", path);
}

/* ---- Command line ---- */

static long number(const char *text, long least, long most)
{
    char *end;
    long value = strtol(text, &end, 10);
    if (end == text || *end != '\0' || value < least || value > most)
        fail("not a number that can be used: ", text);
    return value;
}

int main(int argc, char **argv)
{
    int width, height, depth, i;
    long samples;
    unsigned int seed;
    const char *scene_path = NULL, *out = NULL;
    Scene scene;
    float *means;
    clock_t begin;
    double seconds, rays;

    if (argc < 6)
        fail("usage: rt_weekend WIDTH HEIGHT SAMPLES DEPTH SEED [--scene FILE] [--out FILE.ppm|FILE.pfm]", "");
    width = (int)number(argv[1], 1, 16384);
    height = (int)number(argv[2], 1, 16384);
    samples = number(argv[3], 1, INT_MAX);
    depth = (int)number(argv[4], 1, 10000);
    seed = (unsigned int)number(argv[5], 0, INT_MAX);
    for (i = 6; i < argc; i += 2) {
        if (i + 1 < argc && strcmp(argv[i], "--scene") == 0)
            scene_path = argv[i + 1];
        else if (i + 1 < argc && strcmp(argv[i], "--out") == 0)
            out = argv[i + 1];
        else
            fail("unknown or unfinished option: ", argv[i]);
    }
    if (scene_path != NULL)
        read_scene(&scene, scene_path);
    else
        three_spheres(&scene);
    means = (float *)malloc(3 * sizeof *means * (size_t)width * (size_t)height);
    if (means == NULL)
        fail("out of memory", "");

    printf("tracing\n");
    fflush(stdout);
    begin = clock();
    rays = render(&scene, width, height, samples, depth, seed, means);
    seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
    printf("trace_seconds %.6f paths %.0f rays %.0f\n", seconds, (double)width * height * samples, rays);
    fflush(stdout);

    if (out != NULL)
        write_picture(out, means, width, height);
    free(means);
    free(scene.spheres);
    return 0;
}
