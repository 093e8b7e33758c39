"""The exam: questions with true answers for a model, before it is used in long evaluations.

::

    bank -> gathering -> ExamQuestion -> Examinee.ask -> Answered -> marks, faults -> page
"""
