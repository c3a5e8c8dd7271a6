/* SPDX-License-Identifier: BSD-3-Clause */
/* arkode_order.c -- the order of a Runge-Kutta table, by Butcher's rooted trees.
 *
 * There is one condition for every rooted tree of at most `order` nodes:
 *
 *     sum_i b_i g_i(tree) = 1 / gamma(tree),
 *
 * where g_i of a tree is the product, over the trees t that hang on its root, of
 * sum_j a_ij g_j(t) -- which is c_i for a single node -- and gamma is the product of
 * the sizes of all its subtrees. A tree is written as the depths of its nodes, each
 * node followed by what hangs on it: "0121" is a root that bears a chain of two and a
 * leaf. */
#include "arkode_plugin.h"

#include <math.h>
#include <string.h>

typedef struct tree {
    const char *depths;
    const char *condition;
} tree;

static const tree trees[] = {
    { "0", "sum b_i = 1" },
    { "01", "sum b_i c_i = 1/2" },
    { "011", "sum b_i c_i^2 = 1/3" },
    { "012", "sum b_i a_ij c_j = 1/6" },
    { "0111", "sum b_i c_i^3 = 1/4" },
    { "0121", "sum b_i c_i a_ij c_j = 1/8" },
    { "0122", "sum b_i a_ij c_j^2 = 1/12" },
    { "0123", "sum b_i a_ij a_jk c_k = 1/24" },
    { "01111", "sum b_i c_i^4 = 1/5" },
    { "01211", "sum b_i c_i^2 a_ij c_j = 1/10" },
    { "01212", "sum b_i (a_ij c_j)^2 = 1/20" },
    { "01221", "sum b_i c_i a_ij c_j^2 = 1/15" },
    { "01231", "sum b_i c_i a_ij a_jk c_k = 1/30" },
    { "01222", "sum b_i a_ij c_j^3 = 1/20" },
    { "01232", "sum b_i a_ij c_j a_jk c_k = 1/40" },
    { "01233", "sum b_i a_ij a_jk c_k^2 = 1/60" },
    { "01234", "sum b_i a_ij a_jk a_kl c_l = 1/120" },
};

/* Coefficients that were rounded when they were written. */
#define TOLERANCE 1e-8

/* The node that node k hangs on. */
static size_t parent(const char *depths, size_t k)
{
    size_t p = k;
    while (p > 0 && depths[p] != depths[k] - 1) {
        --p;
    }
    return p;
}

/* Multiplies `by` by A g. */
static void hang_on(const weft_butcher *table, const double *g, bool leaf, double *by)
{
    const size_t s = (size_t)table->stages;
    for (size_t i = 0; i < s; ++i) {
        double sum = 0.0;
        for (size_t j = 0; !leaf && j < i; ++j) {
            sum += table->a[i * s + j] * g[j];
        }
        by[i] *= leaf ? table->c[i] : sum;
    }
}

/* Both sides of the condition. */
static void evaluate(const weft_butcher *table, const double *weights,
                     const char *depths, double *left, double *right)
{
    double g[WEFT__ARK_ORDER_CHECKED][WEFT__ARK_MAX_STAGES];
    size_t size[WEFT__ARK_ORDER_CHECKED];
    const size_t nodes = strlen(depths), s = (size_t)table->stages;
    for (size_t k = 0; k < nodes; ++k) {
        size[k] = 1;
        for (size_t i = 0; i < s; ++i) {
            g[k][i] = 1.0;
        }
    }
    double gamma = 1.0;
    for (size_t k = nodes - 1; k > 0; --k) { /* children come after their parent */
        const size_t p = parent(depths, k);
        hang_on(table, g[k], size[k] == 1, g[p]);
        size[p] += size[k];
        gamma *= (double)size[k];
    }
    *left = 0.0;
    for (size_t i = 0; i < s; ++i) {
        *left += weights[i] * g[0][i];
    }
    *right = 1.0 / (gamma * (double)nodes);
}

bool weft__ark_has_order(const weft_butcher *table, const double *weights, int order,
                         const char **what, double *is, double *wanted)
{
    for (size_t k = 0; k < sizeof trees / sizeof trees[0]; ++k) {
        if (strlen(trees[k].depths) > (size_t)order) {
            break;
        }
        evaluate(table, weights, trees[k].depths, is, wanted);
        if (!(fabs(*is - *wanted) <= TOLERANCE)) {
            *what = trees[k].condition;
            return false;
        }
    }
    return true;
}
