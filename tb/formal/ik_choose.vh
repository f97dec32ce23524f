// SPDX-License-Identifier: Apache-2.0
// Appended to ik_choose, which keeps only its delays: all other instances are left out, so joint steps are arbitrary.
// The branch chosen has the least step of all eight, and a branch counts as inside if no step of its joints is outside.

localparam integer S = STEP + 1;
localparam integer ALL = 14 * S;

// ---- ghost: the steps of the last clocks ----

wire [ALL-1:0] f_0 = {
  step_7_1, step_7_0, step_6_1, step_6_0, step_5_1, step_5_0, step_4_1, step_4_0, step_3_1, step_3_0, step_2_1, step_2_0,
  step_1_1, step_1_0
};
reg [ALL-1:0] f_1, f_2, f_3, f_4, f_5, f_6, f_7;
reg [3:0] f_age = 4'd0;
always @(posedge clk) begin
  {f_7, f_6, f_5, f_4, f_3, f_2, f_1} <= {f_6, f_5, f_4, f_3, f_2, f_1, f_0};
  if (f_age != 4'd8) f_age <= f_age + 4'd1;
end

// Largest step of the shoulder, of the wrist, of all joints; s, e, w: changed bits of the branch
function [S-1:0] f_shoulder(input [ALL-1:0] all, input s, input e);
  f_shoulder = max(max(all[(0+s)*S+:S], all[(2+s)*S+:S]), all[(4+(s^e))*S+:S]);
endfunction
function [S-1:0] f_wrist(input [ALL-1:0] all, input e, input w);
  f_wrist = max(max(all[(8+(e^w))*S+:S], all[(10+w)*S+:S]), all[(12+w)*S+:S]);
endfunction
function [S-1:0] f_branch(input [ALL-1:0] all, input s, input e, input w);
  f_branch = max(max(f_shoulder(all, s, e), all[(6+e)*S+:S]), f_wrist(all, e, w));
endfunction
function [S-1:0] f_least(input [ALL-1:0] all, input e);
  f_least = min(min(f_branch(all, 0, e, 0), f_branch(all, 1, e, 0)), min(f_branch(all, 0, e, 1), f_branch(all, 1, e, 1)));
endfunction
function f_outside(input [ALL-1:0] all, input s, input e, input w);
  f_outside = all[(0+s)*S+STEP] || all[(2+s)*S+STEP] || all[(4+(s^e))*S+STEP] || all[(6+e)*S+STEP]
      || all[(8+(e^w))*S+STEP] || all[(10+w)*S+STEP] || all[(12+w)*S+STEP];
endfunction
// Each ball joint's bit, for elbow bit 0 and 1, has the lesser step
function f_turned(input [ALL-1:0] all, input [3:0] turns);
  f_turned = f_shoulder(all, turns[0], 0) == min(f_shoulder(all, 0, 0), f_shoulder(all, 1, 0))
      && f_shoulder(all, turns[1], 1) == min(f_shoulder(all, 0, 1), f_shoulder(all, 1, 1))
      && f_wrist(all, 0, turns[2]) == min(f_wrist(all, 0, 0), f_wrist(all, 0, 1))
      && f_wrist(all, 1, turns[3]) == min(f_wrist(all, 1, 0), f_wrist(all, 1, 1));
endfunction

// Words of the delays, the newest lowest; each is known once it has been shifted in.
(* hierconn *) wire [8*S-1:0] \u_step_4_late.genblk1.genblk1.g_line.line ;
(* hierconn *) wire [11:0] \u_turns_late.genblk1.genblk1.g_line.line ;
(* hierconn *) wire [3:0] \u_out_4_late.genblk1.genblk1.g_line.line ;
wire [3:0] f_turns = {wrist_turn_1, wrist_turn_0, shoulder_turn_1, shoulder_turn_0};
reg [3:0] f_turns_1, f_turns_2, f_turns_3;
always @(posedge clk) {f_turns_3, f_turns_2, f_turns_1} <= {f_turns_2, f_turns_1, f_turns};

wire [8*S-1:0] f_line_4 = {f_4[6*S+:2*S], f_3[6*S+:2*S], f_2[6*S+:2*S], f_1[6*S+:2*S]};
wire [3:0] f_line_out = {f_2[8*S-1], f_2[7*S-1], f_1[8*S-1], f_1[7*S-1]};
wire [11:0] f_line_turns = {f_turns_3, f_turns_2, f_turns_1};
wire [3:0] f_known;
genvar gi;
generate
  for (gi = 0; gi < 4; gi = gi + 1) begin : g_f
    assign f_known[gi] = f_age <= gi
        || \u_step_4_late.genblk1.genblk1.g_line.line [2*S*gi+:2*S] == f_line_4[2*S*gi+:2*S]
        && (gi >= 2 || \u_out_4_late.genblk1.genblk1.g_line.line [2*(gi%2)+:2] == f_line_out[2*(gi%2)+:2])
        && (gi >= 3 || \u_turns_late.genblk1.genblk1.g_line.line [4*(gi%3)+:4] == f_line_turns[4*(gi%3)+:4]);
  end
endgenerate

// ---- properties, stage by stage ----

always @* begin
  delayed : assert (&f_known);
  if (f_age >= 1) begin
    pairs : assert ({shoulder_pair_0, shoulder_pair_1, wrist_pair_0, wrist_pair_1} == {
      max(f_1[0+:S], f_1[2*S+:S]), max(f_1[S+:S], f_1[3*S+:S]),
      max(f_1[10*S+:S], f_1[12*S+:S]), max(f_1[11*S+:S], f_1[13*S+:S])});
    late : assert ({step_5_1_late, step_5_0_late, step_3_1_late, step_3_0_late} == {f_1[8*S+:2*S], f_1[4*S+:2*S]});
  end
  if (f_age >= 2) begin
    shoulders : assert ({shoulder_00, shoulder_01, shoulder_10, shoulder_11} == {
      f_shoulder(f_2, 0, 0), f_shoulder(f_2, 1, 0), f_shoulder(f_2, 0, 1), f_shoulder(f_2, 1, 1)});
    wrists : assert ({wrist_00, wrist_01, wrist_10, wrist_11} == {
      f_wrist(f_2, 0, 0), f_wrist(f_2, 0, 1), f_wrist(f_2, 1, 0), f_wrist(f_2, 1, 1)});
  end
  if (f_age >= 3) begin
    leasts : assert ({shoulder_least_0, shoulder_least_1, wrist_least_0, wrist_least_1} == {
      min(f_shoulder(f_3, 0, 0), f_shoulder(f_3, 1, 0)), min(f_shoulder(f_3, 0, 1), f_shoulder(f_3, 1, 1)),
      min(f_wrist(f_3, 0, 0), f_wrist(f_3, 0, 1)), min(f_wrist(f_3, 1, 0), f_wrist(f_3, 1, 1))});
    turns : assert (f_turned(f_3, f_turns));
    feasible : assert ({feasible_7, feasible_6, feasible_5, feasible_4, feasible_3, feasible_2, feasible_1, feasible_0}
        == ~{f_outside(f_3, 1, 1, 1), f_outside(f_3, 0, 1, 1), f_outside(f_3, 1, 0, 1), f_outside(f_3, 0, 0, 1),
             f_outside(f_3, 1, 1, 0), f_outside(f_3, 0, 1, 0), f_outside(f_3, 1, 0, 0), f_outside(f_3, 0, 0, 0)});
  end
  if (f_age >= 4) begin
    balls : assert ({balls_0, balls_1} == {
      max(min(f_shoulder(f_4, 0, 0), f_shoulder(f_4, 1, 0)), min(f_wrist(f_4, 0, 0), f_wrist(f_4, 0, 1))),
      max(min(f_shoulder(f_4, 0, 1), f_shoulder(f_4, 1, 1)), min(f_wrist(f_4, 1, 0), f_wrist(f_4, 1, 1)))});
    turns_1 : assert (f_turned(f_4, f_turns_1));
  end
  if (f_age >= 5) begin
    arms : assert ({arm_0, arm_1} == {f_least(f_5, 0), f_least(f_5, 1)});
    turns_2 : assert (f_turned(f_5, f_turns_2));
  end
  if (f_age >= 6) begin
    least_of_all : assert (least == min(f_least(f_6, 0), f_least(f_6, 1)));
    elbow_turned : assert (f_least(f_6, turn_elbow) == least);
    turns_3 : assert (f_turned(f_6, f_turns_3));
  end
  if (f_age >= 7)
    chosen : assert (f_branch(f_7, turn_shoulder, turn_elbow_late, turn_wrist) == min(f_least(f_7, 0), f_least(f_7, 1)));
end
