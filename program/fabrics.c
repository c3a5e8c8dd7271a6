/* SPDX-License-Identifier: BSD-3-Clause */
/* fabrics.c -- weft fabrics: the presets of cloth.fabric.preset. */
#include "program/cli.h"
#include "program/record/yaml_out.h"

#include <string.h>

#define SOURCE                                                                         \
    "Wang, O'Brien, Ramamoorthi: Data-driven elastic models for cloth, ACM Trans. "    \
    "Graph. 30(4), 71, 2011"

static const double gravity = 9.81, micro = 1e6, milli = 1e3;

/* What the authors measured, from materials/README of ARCSim (src/cloth/fabric.c). */
static const struct {
    const char *name, *what;
} samples[] = {
    { "tango-red-jet-set", "jacket, polyester" },
    { "white-dots-on-blk", "tablecloth, polyester" },
    { "gray-interlock", "T-shirt, 60 % cotton, 40 % polyester" },
    { "white-swim-solid", "swimsuit, 87 % nylon, 13 % spandex" },
    { "royal-target", "trousers, 65 % cotton, 35 % polyester" },
    { "pink-ribbon-brown", "blanket, polyester" },
    { "ivory-rib-knit", "underwear, 95 % cotton, 5 % spandex" },
    { "camel-ponte-roma", "jacket, 60 % polyester, 40 % rayon" },
    { "11oz-black-denim", "jeans, 99 % cotton, 1 % spandex" },
};

static const char *sample_of(const weft_fabric *fabric)
{
    for (size_t i = 0; i < sizeof samples / sizeof samples[0]; ++i) {
        if (strcmp(samples[i].name, fabric->name) == 0) {
            return samples[i].what;
        }
    }
    return "";
}

/* With a format of the name, nine numbers and, if it has a place for it, the sample. */
static void print_rows(const char *format)
{
    size_t count;
    const weft_fabric *all = weft_fabric_presets(&count);
    for (const weft_fabric *of = all; of < all + count; ++of) {
        printf(format, of->name, of->density, of->stretch[0], of->stretch[1], of->shear,
               micro * of->bend[0], micro * of->bend[1], micro * of->twist,
               milli * weft_fabric_length(of, 0, gravity),
               milli * weft_fabric_length(of, 1, gravity), sample_of(of));
    }
}

static void print_samples(void)
{
    size_t count;
    const weft_fabric *all = weft_fabric_presets(&count);
    for (const weft_fabric *of = all; of < all + count; ++of) {
        printf("%-18s  %s\n", of->name, sample_of(of));
    }
}

static void print_text(void)
{
    puts("preset              density     stretch   shear       bend   twist      "
         "length\n"
         "                     kg/m^2         N/m     N/m   1e-6 N m  1e-6 N m        "
         "mm");
    print_rows("%-18s %8.3f  %4.0f %5.0f  %6.1f  %4.1f %4.1f  %8.1f  %4.1f %4.1f\n");
    puts("\npreset              sample");
    print_samples();
    puts("\npairs: warp (along a column), weft (along a row); length: Peirce's, of "
         "bending");
    print_wrapped(0, 0, PAGE_WIDTH,
                  "source: " SOURCE
                  "; bend and twist are a quarter of its coefficients");
}

static void print_markdown(void)
{
    puts("| preset | density [kg/m^2] | stretch [N/m] | shear [N/m] | bend [1e-6 N m] "
         "| twist [1e-6 N m] | Peirce length [mm] | sample |\n"
         "|---|---|---|---|---|---|---|---|");
    print_rows(
        "| `%s` | %.3f | %.0f, %.0f | %.1f | %.1f, %.1f | %.1f | %.1f, %.1f | %s |\n");
}

static int print_yaml(void)
{
    size_t count;
    yaml_out out;
    const weft_fabric *all = weft_fabric_presets(&count);
    yaml_out_begin(&out, stdout);
    yaml_out_write(&out, "fabrics: [");
    for (const weft_fabric *of = all; of < all + count; ++of) {
        yaml_out_write(&out,
                       "{ name: \"%s\", density: %g, stretch_warp: %g, "
                       "stretch_weft: %g, shear: %g, bend_warp: %g, bend_weft: %g, "
                       "twist: %g, length_warp: %g, length_weft: %g, sample: \"%s\", "
                       "source: \"%s\" }",
                       of->name, of->density, of->stretch[0], of->stretch[1], of->shear,
                       of->bend[0], of->bend[1], of->twist,
                       weft_fabric_length(of, 0, gravity),
                       weft_fabric_length(of, 1, gravity), sample_of(of), SOURCE);
    }
    yaml_out_write(&out, "]");
    return yaml_out_end(&out) ? EXIT_DONE : EXIT_FILE;
}

static int fabrics_verb(const arguments *given)
{
    if (given->yaml) {
        return print_yaml();
    }
    (given->markdown ? print_markdown : print_text)();
    return EXIT_DONE;
}

static const verb_option options[] = {
    SHARED(yaml, "yaml", NULL, "as YAML, in SI units, with the source"),
    SHARED(markdown, "markdown", NULL, "the table of the documentation"),
};

const verb verb_fabrics = {
    .name = "fabrics",
    .summary = "list measured fabrics for cloth.fabric.preset",
    .help = "usage: weft fabrics [OPTIONS]\n"
            "\n"
            "Lists the measured fabrics that a scene can name, with their moduli, each "
            "with a pair of values along a column (warp) and along a row (weft), and "
            "with Peirce's bending length (bend / (density g))^(1/3): a grid shows the "
            "bends of a fabric if its spacing is at most half of it.\n",
    OPTIONS(options),
    .more = "example: weft run scene.yaml --set cloth.fabric.preset=royal-target\n",
    .operands = { 0, 0, "takes no file", NULL },
    .run = fabrics_verb,
};
