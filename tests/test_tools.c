/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow */
/* Scripts of tools/ on which the gate relies. */
#include "shell.h"

#define OUT BUILD_DIR "/tools-test"

/* tools/rules/tree in a repository of its own, OUT/tree; false without git. */
static bool new_repository(void)
{
    if (shell("command -v git") != 0) {
        return false;
    }
    expect(
        shell("rm -rf " OUT "/tree && mkdir -p " OUT "/tree && cd " OUT
              "/tree && git init -q . && printf 'build/\\nignored/\\n' >.gitignore && "
              "echo 1 >a && echo 2 >b && git add . && git -c user.name=a -c "
              "user.email=a@b commit -q -m a"),
        0);
    return true;
}

/* What tools/rules/tree says after a command. */
static int tree(const char *first, const char *words)
{
    return shell("tools=$PWD/tools && cd " OUT
                 "/tree && %s && $tools/rules/tree build/tree %s 2>&1",
                 first, words);
}

START_TEST(a_stage_that_leaves_a_file_in_the_tree_is_named)
{
    if (!new_repository()) {
        return;
    }
    expect(tree("echo of the user >>b", "remember"), 0);
    expect(tree("true", "begin one"), 0);
    expect(tree("mkdir build/o && touch build/o/object", "end one"), 0);
    expect(tree("true", "begin two"), 0);
    expect(tree("mkdir ignored && touch ignored/x && touch 'with blank' && rm a",
                "end two"),
           1);
    says("tree: ignored/x was written or removed while ");
    says("two ran\n");
    says("tree: with blank was ");
    says("tree: a was ");
    ck_assert_ptr_null(strstr(output, "tree: b "));
    expect(tree("true", "end two"), 0); /* said once */
    expect(tree("echo more >>b", "end two"), 1);
    says("tree: b was ");
    expect(tree("git checkout -q b", "end two"), 1); /* the user's text is lost */
    says("tree: b was ");
}
END_TEST

/* What `git commit` says to a message in OUT/tree, where the hook is installed. */
static int commit(const char *message)
{
    return shell("cd " OUT
                 "/tree && date +%%N >a && git add a && git -c user.name=a -c "
                 "user.email=a@b commit -q -m \"$(printf '%s')\" 2>&1",
                 message);
}

START_TEST(the_hook_takes_messages_of_the_form_and_refuses_others)
{
    if (!new_repository()) {
        return;
    }
    expect(shell("tools=$PWD/tools && cd " OUT "/tree && $tools/rules/hooks"), 0);
    expect(commit("a: keep the state after a failed step"), 0);
    expect(commit("a: pass the state on\\n\\nThe cause; the change. The effect."), 0);
    expect(commit("keep the state"), 1);
    says("the subject is 'module: imperative summary'");
    expect(commit("sim: keep the state"), 1);
    says("'sim' is no folder or file of this tree");
    expect(commit("a: keep the state; free the rest"), 1);
    says("semicolon");
    expect(commit("a: keep the state."), 1);
    says("period");
    expect(commit("a: keeps the state"), 1);
    says("begins with 'keeps'");
    expect(commit("a: Added a state"), 1);
    says("begins with 'added'");
    expect(commit("a: keep the state\\nof a step"), 1);
    says("the second line is empty");
    expect(commit("a: keep the state of every step in which a particle is not finite "
                  "at all times"),
           1);
    says("has 78 characters; at most 72");
}
END_TEST

START_TEST(a_hook_of_the_user_stays)
{
    if (!new_repository()) {
        return;
    }
    expect(shell("tools=$PWD/tools && cd " OUT "/tree && echo true "
                 ">.git/hooks/commit-msg && $tools/rules/hooks 2>&1"),
           1);
    says("commit-msg is not weft's: it stays");
    expect(shell("cat " OUT "/tree/.git/hooks/commit-msg"), 0);
    says("true");
}
END_TEST

START_TEST(every_target_names_the_programs_that_it_lacks_before_it_begins)
{
    if (shell("command -v git && command -v python3") != 0) {
        return;
    }
    expect(shell("env -u MAKEFLAGS -u MAKELEVEL -u MFLAGS tests/needs.sh " OUT
                 "/needs 2>&1"),
           0);
    ck_assert_str_eq(output, "");
}
END_TEST

TEST_SUITE(tools)
{
    Suite *all = suite_create("tools");
    TCase *gate = tcase_create("gate");
    tcase_add_test(gate, a_stage_that_leaves_a_file_in_the_tree_is_named);
    tcase_add_test(gate, the_hook_takes_messages_of_the_form_and_refuses_others);
    tcase_add_test(gate, a_hook_of_the_user_stays);
    suite_add_tcase(all, gate);
    TCase *needs = tcase_create("needs");
    tcase_set_timeout(needs, 240);
    tcase_add_test(needs,
                   every_target_names_the_programs_that_it_lacks_before_it_begins);
    suite_add_tcase(all, needs);
    return all;
}
