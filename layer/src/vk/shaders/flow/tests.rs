use super::*;
use crate::vk::shaders::effects::tests::assemble;
use crate::vk::shaders::effects::{Effects, FragmentShaders};

const MAIN: u32 = 1;
const HELPER: u32 = 2;
const BOOL: u32 = 3;
const INT: u32 = 4;
const LONG: u32 = 5;
const NAME: u32 = u32::from_le_bytes(*b"main");

/// The specialisation constant, with the number 7, and results of the code.
const CONSTANT: u32 = 10;
const NUMBER: u32 = 7;
const TWO: u32 = 11;
const UNKNOWN: u32 = 12;
const RESULT: u32 = 13;

type Lines<'a> = &'a [(u32, &'a [u32])];

/// A fragment shader with a constant of 32 bits, 0 by default.
fn module(global: Lines<'_>, main: Lines<'_>, helper: Lines<'_>) -> Vec<u32> {
    let head: Lines<'_> = &[
        (op::ENTRY_POINT, &[MODEL_FRAGMENT, MAIN, NAME, 0]),
        (op::DECORATE, &[CONSTANT, decoration::SPEC_ID, NUMBER]),
        (op::TYPE_BOOL, &[BOOL]),
        (op::TYPE_INT, &[INT, 32, 0]),
        (op::TYPE_INT, &[LONG, 64, 0]),
        (op::CONSTANT, &[INT, TWO, 2]),
    ];
    let mut code: Vec<(u32, Vec<u32>)> = Vec::new();
    let mut add = |lines: Lines<'_>| code.extend(lines.iter().map(|(op, operands)| (*op, operands.to_vec())));
    add(head);
    add(global);
    for (id, body) in [(MAIN, main), (HELPER, helper)] {
        add(&[(op::FUNCTION, &[30, id, 0, 31])]);
        add(body);
        add(&[(op::FUNCTION_END, &[])]);
    }
    assemble(&code)
}

const FLAG: Lines<'static> = &[(op::SPEC_CONSTANT_FALSE, &[BOOL, CONSTANT])];
const WORD: Lines<'static> = &[(op::SPEC_CONSTANT, &[INT, CONSTANT, 0])];
const RETURN: (u32, &[u32]) = (op::RETURN, &[]);

fn discards(words: &[u32], value: Option<u32>) -> bool {
    let constants = value.map(|value| (NUMBER, value));
    Flow::read(words).is_none_or(|flow| flow.discards("main", &Specialization::of(constants.as_slice())))
}

/// With the constant unset, 0, 1, 2.
fn cases(words: &[u32]) -> [bool; 4] {
    assert!(FragmentShaders::read(words).unwrap().effects("main").discards);
    [None, Some(0), Some(1), Some(2)].map(|value| discards(words, value))
}

/// A branch on `condition`, within whose first way an unknown test discards.
fn alpha_test(condition: u32) -> Vec<(u32, Vec<u32>)> {
    [
        (op::LABEL, vec![50]),
        (op::SELECTION_MERGE, vec![54, 0]),
        (op::BRANCH_CONDITIONAL, vec![condition, 51, 54]),
        (op::LABEL, vec![51]),
        (op::BRANCH_CONDITIONAL, vec![UNKNOWN, 52, 53]),
        (op::LABEL, vec![52]),
        (op::KILL, vec![]),
        (op::LABEL, vec![53]),
        (op::BRANCH, vec![54]),
        (op::LABEL, vec![54]),
        (op::RETURN, vec![]),
    ]
    .into()
}

fn tested(global: Lines<'_>, condition: u32) -> Vec<u32> {
    let body = alpha_test(condition);
    let body: Vec<(u32, &[u32])> = body.iter().map(|(op, operands)| (*op, &operands[..])).collect();
    module(global, &body, &[])
}

#[test]
fn a_flag_turns_the_test_off() {
    assert_eq!(cases(&tested(FLAG, CONSTANT)), [false, false, true, true]);
    let on = [(op::SPEC_CONSTANT_TRUE, &[BOOL, CONSTANT][..])];
    assert_eq!(cases(&tested(&on, CONSTANT)), [true, false, true, true]);
}

#[test]
fn comparisons_of_constants_are_known() {
    for (op, expected) in [
        (op::I_EQUAL, [false, false, false, true]),
        (op::I_NOT_EQUAL, [true, true, true, false]),
        (op::U_LESS_THAN, [true, true, true, false]),
        (op::U_GREATER_THAN_EQUAL, [false, false, false, true]),
        (op::S_LESS_THAN_EQUAL, [true; 4]),
    ] {
        let compare = [BOOL, RESULT, op, CONSTANT, TWO];
        let global = [WORD[0], (op::SPEC_CONSTANT_OP, &compare[..])];
        assert_eq!(cases(&tested(&global, RESULT)), expected, "{op}");
    }
}

/// As DXVK does: a constant selects another one, or a buffer.
#[test]
fn a_part_of_a_word_selected_by_a_constant() {
    let global = [
        WORD[0],
        (op::CONSTANT, &[INT, 20, 1][..]),
        (op::CONSTANT, &[INT, 21, 0]),
        (op::SPEC_CONSTANT_OP, &[INT, 22, op::BIT_FIELD_U_EXTRACT, CONSTANT, 20, 20]),
        (op::SPEC_CONSTANT_OP, &[INT, 23, op::BITWISE_AND, CONSTANT, 20]),
        (op::SPEC_CONSTANT_OP, &[BOOL, 24, op::I_NOT_EQUAL, 22, 21]),
        (op::SPEC_CONSTANT_OP, &[BOOL, 25, op::I_EQUAL, 23, 20]),
        (op::SPEC_CONSTANT_OP, &[BOOL, RESULT, op::SELECT, 24, 25, UNKNOWN]),
    ];
    // Bit 1 means that bit 0 is valid: with 2 it is valid, and off.
    assert_eq!(cases(&tested(&global, RESULT)), [true, true, true, false]);
}

#[test]
fn a_switch_goes_one_way() {
    let main: Lines<'_> = &[
        (op::LABEL, &[50]),
        (op::SWITCH, &[CONSTANT, 52, 1, 51, 2, 53]),
        (op::LABEL, &[51]),
        (op::KILL, &[]),
        (op::LABEL, &[52]),
        RETURN,
        (op::LABEL, &[53]),
        (op::BRANCH, &[51]),
    ];
    assert_eq!(cases(&module(WORD, main, &[])), [false, false, true, true]);
}

/// A called function discards where the call is reached.
#[test]
fn calls_are_followed() {
    let main: Lines<'_> = &[
        (op::LABEL, &[50]),
        (op::BRANCH_CONDITIONAL, &[CONSTANT, 51, 52]),
        (op::LABEL, &[51]),
        (op::FUNCTION_CALL, &[32, 60, HELPER]),
        (op::BRANCH, &[52]),
        (op::LABEL, &[52]),
        RETURN,
    ];
    let helper: Lines<'_> = &[(op::LABEL, &[70]), (op::DEMOTE_TO_HELPER_INVOCATION, &[]), RETURN];
    assert_eq!(cases(&module(FLAG, main, helper)), [false, false, true, true]);
}

/// Anything that is not followed counts as a discard.
#[test]
fn whatever_is_not_understood_discards() {
    assert_eq!(cases(&tested(FLAG, UNKNOWN)), [true; 4], "another condition");
    let long = [(op::SPEC_CONSTANT, &[LONG, CONSTANT, 0, 0][..])];
    assert_eq!(cases(&tested(&long, CONSTANT)), [true; 4], "another type");
    let words = tested(FLAG, CONSTANT);
    let flow = Flow::read(&words).unwrap();
    assert!(flow.discards("another", &Specialization::default()));
    for length in 0..words.len() {
        // Cut off anywhere: no panic.
        assert!(Flow::read(&words[..length]).is_none_or(|flow| {
            flow.discards("main", &Specialization::default());
            true
        }));
    }
    // A second way to the same discard.
    let main: Lines<'_> = &[
        (op::LABEL, &[50]),
        (op::BRANCH_CONDITIONAL, &[CONSTANT, 52, 51]),
        (op::LABEL, &[51]),
        (op::BRANCH_CONDITIONAL, &[UNKNOWN, 52, 53]),
        (op::LABEL, &[52]),
        (op::KILL, &[]),
        (op::LABEL, &[53]),
        RETURN,
    ];
    assert_eq!(cases(&module(FLAG, main, &[])), [true; 4]);
    assert_eq!(
        FragmentShaders::read(&words).unwrap().effects("main"),
        Effects { discards: true, ..Effects::default() }
    );
}
